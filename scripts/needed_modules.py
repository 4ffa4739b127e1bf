"""Python modules that a script needs, of Debian's packages."""

import pathlib
import subprocess
import sys


def install_missing(packages):
    """Of module -> package those that cannot be imported."""
    missing = []
    for module, package in packages.items():
        try:
            __import__(module)
        except ImportError:
            missing.append(package)
    if missing:
        script = pathlib.Path(__file__).resolve().parent / "install-packages"
        subprocess.run([str(script), *missing], check=True, stdout=sys.stderr)
