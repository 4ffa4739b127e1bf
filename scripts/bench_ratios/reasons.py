"""Why a target is missed, for as long as it is."""

REASONS = ""
