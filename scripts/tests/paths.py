"""Makes the packages beside this folder importable, and gives the paths of the tree."""
import sys
from pathlib import Path

SCRIPTS = Path(__file__).resolve().parents[1]
REFERENCE = SCRIPTS.parent / "results" / "reference" / "0.1.0"
sys.path.insert(0, str(SCRIPTS))

