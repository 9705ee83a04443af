#!/usr/bin/python3
"""Runs a program that takes FACTOR times its processor seconds: gate_planted_slowdown.py FACTOR PROGRAM ARGUMENTS"""
import resource
import subprocess
import sys
import time

factor = float(sys.argv[1])
exit_code = subprocess.call(sys.argv[2:])
used = resource.getrusage(resource.RUSAGE_CHILDREN)
extra_s = (factor - 1) * (used.ru_utime + used.ru_stime)
while time.process_time() < extra_s:  # counts this interpreter's start too
    pass
sys.exit(exit_code)
