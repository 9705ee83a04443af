"""Refuses processors that lack instructions for which the extension module is compiled."""

from __future__ import annotations

from .built_for import MARCH

_NEEDED = {"x86-64-v3": {"avx2", "bmi1", "bmi2", "fma"}}


def check_processor(description: str = "/proc/cpuinfo") -> None:
    """Raises ImportError if the description of the processor, a file, lacks instructions."""
    try:
        with open(description, encoding="ascii", errors="replace") as file:
            flags = next((line.split(":")[1].split() for line in file if line.startswith("flags")), None)
    except OSError:
        return
    missing = _NEEDED.get(MARCH, set()) - set(flags or ())
    if flags and missing:
        raise ImportError(f"podm: this processor has no {', '.join(sorted(missing))}; the package needs one of the "
                          f"level {MARCH} (2013 or later)")
