"""Counts the meshes for which each claim of podm-verify was decided: meshes of podm, and those of other meshers
apart."""
import pandas

PREFIX = "verdicts."
WORDS = ("pass", "fail", "not_run")


def ours(frame):
    """One line per claim: the number of podm's meshes by verdict."""
    rows = frame[frame["mesher"] == "podm"] if len(frame) else frame
    return pandas.DataFrame([{"claim": claim, **_counts(rows, claim)} for claim in _claims(rows)],
                            columns=["claim", *WORDS])


def of_others(frame):
    """One line per mesher and claim, with a flag for claims that the mesher promises."""
    rows = frame[frame["mesher"] != "podm"] if len(frame) else frame
    lines = [{"mesher": mesher, "claim": claim, "promised": _promises(group, claim), **_counts(group, claim)}
             for mesher, group in rows.groupby("mesher") for claim in _claims(group)] if len(rows) else []
    return pandas.DataFrame(lines, columns=["mesher", "claim", "promised", *WORDS])


def readable(table):
    """podm's claims with their verdicts; for other meshers one line per claim and one column per mesher."""
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
    """Returns "fail" if any mesh failed, and "not_run" if no mesh was judged."""
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
