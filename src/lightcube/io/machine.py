"""What the machine has."""

import os
from pathlib import Path


def free_memory() -> int:
    """Bytes of memory that a program can still have; where the system does not tell, what the machine has."""
    limits = []
    try:
        lines = Path("/proc/meminfo").read_text().splitlines()
        limits += [int(line.split()[1]) * 1024 for line in lines if line.startswith("MemAvailable:")]
        most, used, parts = (Path(f"/sys/fs/cgroup/memory.{name}").read_text() for name in ("max", "current", "stat"))
        cache = sum(int(line.split()[1]) for line in parts.splitlines() if line.startswith("inactive_file "))
        limits += [] if most.strip() == "max" else [int(most) - int(used) + cache]
    except OSError:
        pass
    if limits:
        return max(min(limits), 0)
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return 8 * 2**30
