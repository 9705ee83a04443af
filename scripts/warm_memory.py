"""Memory that a virtual machine's host has yet to provide is slow at its first touch; see harness/warm_memory.h."""
import subprocess
import sys

TOUCH = """
import mmap, sys
memory = mmap.mmap(-1, int(sys.argv[1]))
memory.madvise(mmap.MADV_HUGEPAGE)
memory[::4096] = bytes(len(memory) // 4096)
"""


def warm_memory(size_bytes=2**30):
    """In a process of its own, whose memory is free again when it ends."""
    subprocess.run([sys.executable, "-c", TOUCH, str(size_bytes)], check=False)
