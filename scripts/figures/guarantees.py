"""How many meshes each claim of podm-verify was decided for: of ours, and of other meshers apart."""
import pandas

PREFIX = "verdicts."
WORDS = ("pass", "fail", "not_run")


def ours(frame):
    """One line a claim: numbers of our meshes by verdict."""
    rows = frame[frame["mesher"] == "podm"] if len(frame) else frame
    return pandas.DataFrame([{"claim": claim, **_counts(rows, claim)} for claim in _claims(rows)],
                            columns=["claim", *WORDS])


def of_others(frame):
    """One line a mesher and claim, and whether the mesher promises it."""
    rows = frame[frame["mesher"] != "podm"] if len(frame) else frame
    lines = [{"mesher": mesher, "claim": claim, "promised": _promises(group, claim), **_counts(group, claim)}
             for mesher, group in rows.groupby("mesher") for claim in _claims(group)] if len(rows) else []
    return pandas.DataFrame(lines, columns=["mesher", "claim", "promised", *WORDS])


def readable(table):
    """Ours with the verdict of each claim; others beside each other, a line a claim."""
    if "mesher" not in table:
        shown = table.rename(columns={"not_run": "not run"})
        shown.insert(1, "verdict", [verdict_of(line) for line in table.to_dict("records")])
        return shown
    meshers = sorted(table["mesher"].unique())
    texts = {(line["claim"], line["mesher"]): _text(line) for line in table.to_dict("records")}
    return pandas.DataFrame([[claim, *(texts.get((claim, mesher), "") for mesher in meshers)]
                             for claim in sorted(table["claim"].unique())], columns=["claim", *meshers])


def _text(line):
    decided = line["pass"] + line["fail"]
    text = f"holds for {line['pass']} of {decided}" if decided else "not run"
    return text + (", promised" if line["promised"] else "")


def verdict_of(line):
    """One failure is a failure; a claim that was never run holds for nothing."""
    return "fail" if line["fail"] else "pass" if line["pass"] else "not_run"


def _claims(rows):
    names = [name for name in rows if name.startswith(PREFIX) and rows[name].isin(WORDS).any()]
    return sorted(name.removeprefix(PREFIX) for name in names)


def _counts(rows, claim):
    return {word: int((rows[PREFIX + claim] == word).sum()) for word in WORDS}


def _promises(rows, claim):
    if "promises" not in rows:
        return False
    return any(claim in promised for promised in rows["promises"] if isinstance(promised, list))
