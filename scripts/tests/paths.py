"""Makes the packages beside this folder importable, and says where the tree is."""
import json
import sys
from pathlib import Path

SCRIPTS = Path(__file__).resolve().parents[1]
REFERENCE = SCRIPTS.parent / "results" / "reference" / "amd-epyc-zen5-2-cores"
sys.path.insert(0, str(SCRIPTS))


def has_reference():
    """Whether its files hold rows, and none of another schema than is read."""
    from figures.load import SCHEMA

    firsts = [json.loads(path.read_text().splitlines()[0]) for path in REFERENCE.rglob("*.jsonl")]
    schemas = {first["schema"] for first in firsts if isinstance(first.get("schema"), int)}
    return schemas == {SCHEMA}
