"""The described machines of simulated rows, with the constants that were fitted."""
import pandas

PREFIX = "virtual.machine."
COLUMNS = ["name", "path", "sha256", "constants", "rows"]


def machine(frame):
    """One line per machine; `constants` as text. Empty if no row has its machine."""
    if PREFIX + "sha256" not in frame:
        return pandas.DataFrame(columns=COLUMNS)
    lines = []
    for sha256, rows in frame.groupby(PREFIX + "sha256", sort=False):
        last = rows.iloc[-1]
        constants = [f"{name.removeprefix(PREFIX + 'constants.')} = {last[name]:.4g}" for name in frame
                     if name.startswith(PREFIX + "constants.") and pandas.notna(last[name])]
        lines.append({"name": last.get(PREFIX + "name"), "path": last.get(PREFIX + "path"), "sha256": sha256,
                      "constants": ", ".join(constants), "rows": len(rows)})
    return pandas.DataFrame(lines, columns=COLUMNS)


def readable(table):
    return table.assign(sha256=table["sha256"].str[:12])
