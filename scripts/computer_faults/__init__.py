"""The parts of scripts/computer-faults."""
