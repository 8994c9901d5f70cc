"""What the machine and its software are called."""

import platform
from pathlib import Path
from typing import Any

import llvmlite.binding
import numba
import numpy as np

from lightcube.cores import free_cores
from lightcube.kernels import tasks

_CACHES = Path("/sys/devices/system/cpu/cpu0/cache")


def machine() -> dict[str, Any]:
    """Processor, cores that this program may use, caches where the system tells, versions."""
    return {
        "processor": _processor(),
        "architecture": platform.machine(),
        "llvm_name": llvmlite.binding.get_host_cpu_name(),
        "cores": free_cores(),
        "threads": tasks.threads(),
        "caches": _caches(),
        "system": platform.system(),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "numba": numba.__version__,
        "llvm": ".".join(map(str, llvmlite.binding.llvm_version_info)),
    }


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or "unknown"


def _caches() -> list[str]:
    """Such as ``L2 1024K``, of the first core."""
    try:
        described = [
            [(folder / name).read_text().strip() for name in ("level", "size", "type")]
            for folder in sorted(_CACHES.glob("index*"))
        ]
    except OSError:
        return []
    return [f"L{level} {size}" for level, size, kind in described if kind != "Instruction"]
