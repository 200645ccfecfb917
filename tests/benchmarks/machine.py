"""The machine and the versions that a benchmark ran with."""

import importlib.metadata
import os
import platform
import subprocess
from pathlib import Path

import numpy as np
import scipy.linalg  # noqa: F401 - loads the BLAS of SciPy
from threadpoolctl import threadpool_info

import bemcontact

PACKAGES = ("numpy", "scipy", "numba", "cvxpy", "clarabel", "piqp", "scikit-fem", "unopy", "casadi")


def described() -> dict[str, str]:
    """Names and values for the page."""
    blas = {f"{item['internal_api']} {item['version']} ({item.get('architecture', '')})" for item in _blas()}
    return {
        "Processor": f"{processor()}, {os.cpu_count()} cores",
        "System": f"{platform.system()} {platform.machine()}, Python {platform.python_version()}",
        "bemcontact": f"{bemcontact.__version__}, {commit()}",
        "BLAS": ", ".join(sorted(blas)),
        **{name: version(name) for name in PACKAGES},
        "Threads": "1, if not said otherwise",
    }


def _blas() -> list[dict]:
    np.ones((2, 2)) @ np.ones((2, 2))
    return [item for item in threadpool_info() if item["user_api"] == "blas"]


def processor() -> str:
    """Name of the processor."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text(encoding="utf-8").splitlines() if info.is_file() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or "unknown"


def version(package: str) -> str:
    """Version of an installed package, or that it is absent."""
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "not installed"


def commit() -> str:
    """Commit of the package that is measured, if it is in a repository."""
    folder = Path(bemcontact.__file__).parent
    try:
        words = ["git", "-C", str(folder), "describe", "--always", "--dirty", "--exclude=*"]
        return "commit " + subprocess.run(words, check=True, capture_output=True, encoding="utf-8").stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "no commit"


def load() -> float:
    """Mean number of processes that wanted to run in the last minute; 0 where nothing tells it."""
    return os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0
