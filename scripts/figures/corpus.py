"""The images of a corpus, each meshed unattended in several settings (corpus.toml): how many succeed, and the cost."""
import numpy
import pandas

from . import style

EXPERIMENT = "corpus"
SUCCESS, REFUSED, FAILED = "success", "refused", "failed"
EXIT_INPUT = 2  # a program exits with it if it refuses its input
MOST_WORST = 10
COLUMNS = ["image", "setting", "mesher", "outcome", "why", "proved", "promised", "seconds", "memory_mib", "cells",
           "voxels", "beyond_bounds", "cores"]
COLOURS = {"default": "#2b7bba", "smooth": "#3d8b5f", "slivers": "#e8a33d", "cgal": "#d1495b"}
NOTE = ("Success: the mesh passes every claim that its mesher promises. Refused: the mesher gives the fault of the "
        "file in one sentence and writes nothing; this is no success. Seconds and memory are those of the whole "
        "process, with reading and writing. Cells beyond bounds have a dihedral angle below 8 or above 165 degrees "
        "after both stages against slivers.")


def corpus(frame):
    """One line per image and setting, of its newest row; by image, in the order of the settings."""
    rows = _rows(frame)
    lines = [_line(row) for row in rows.to_dict("records")]
    table = pandas.DataFrame(lines, columns=["path", *COLUMNS]).drop_duplicates(["path", "setting"], keep="last")
    table["image"] = _distinct_names(table)
    table = table[COLUMNS]
    order = {setting: place for place, setting in enumerate(COLOURS)}
    return table.sort_values(["image", "setting"], ignore_index=True,
                             key=lambda column: column.map(order) if column.name == "setting" else column)


def rates(table):
    """One line per setting: the number of images by outcome, and the share of successes among all files."""
    images, lines = table["image"].nunique(), []
    for setting, group in table.groupby("setting", sort=False):
        counts = group["outcome"].value_counts()
        succeeded, refused = int(counts.get(SUCCESS, 0)), int(counts.get(REFUSED, 0))
        lines.append({"setting": setting, "images": len(group), SUCCESS: succeeded, REFUSED: refused,
                      FAILED: len(group) - succeeded - refused, "rate": succeeded / len(group),
                      "without a row": images - len(group), "cells beyond bounds": group["beyond_bounds"].sum()})
    return pandas.DataFrame(lines, columns=["setting", "images", SUCCESS, REFUSED, FAILED, "rate", "without a row",
                                            "cells beyond bounds"])


def worst(table):
    """The images and settings that cost most: first those without success, then by seconds per voxel."""
    made = table.assign(is_success=table["outcome"] == SUCCESS, per_voxel=table["seconds"] / table["voxels"])
    return made.sort_values(["is_success", "per_voxel"], ascending=[True, False]).head(MOST_WORST)[COLUMNS]


def summary(table):
    """Returns a sentence per setting."""
    sentences = []
    for line in rates(table).to_dict("records"):
        others = [f"{line[word]} {word}" for word in (REFUSED, FAILED) if line[word]]
        sentences.append(f"{line['setting']}: {line[SUCCESS]} of {line['images']} images"
                         + (f" ({', '.join(others)})" if others else ""))
    return "; ".join(sentences) + "."


def why_without_rows(table):
    """Returns a sentence about images that have no row of CGAL; empty if each has one."""
    images, theirs = set(table["image"]), set(table.loc[table["setting"] == "cgal", "image"])
    missing = sorted(images - theirs)
    if not missing:
        return ""
    return (f"No row of CGAL's mesher for {len(missing)} of {len(images)} images ({', '.join(missing)}): it is not "
            "built (make peers), or its adapter does not read such a file.")


def readable(table):
    shown = table[["image", "setting", "outcome", "why"]].copy()
    shown["claims"] = [f"{line['proved']} of {line['promised']}" if line["promised"] else ""
                       for line in table.to_dict("records")]
    for name, title, digits in (("seconds", "seconds", 2), ("memory_mib", "memory, MiB", 0)):
        shown[title] = [_fixed(value, digits) for value in table[name]]
    shown["M cells"] = [_fixed(value / 1e6, 3) for value in table["cells"]]
    shown["M voxels"] = [_fixed(value / 1e6, 2) for value in table["voxels"]]
    shown["cells beyond bounds"] = [_fixed(value, 0) for value in table["beyond_bounds"]]
    return shown


def readable_rates(table):
    return table.assign(rate=[f"{100 * rate:.0f} %" for rate in table["rate"]],
                        **{"cells beyond bounds": [f"{value:.0f}" if setting == "slivers" else "" for setting, value in
                                                   zip(table["setting"], table["cells beyond bounds"])]})


def figure(frame):
    """Draws seconds over voxels by setting. None without a mesh of a corpus."""
    table = corpus(frame)
    made = table[table["cells"].notna() & table["voxels"].notna()]
    if made.empty:
        return None
    drawn, (axes,) = style.new_figure(width=7.5, height=4.4)
    for setting, group in made.groupby("setting", sort=False):
        is_success = group["outcome"] == SUCCESS
        colour = COLOURS.get(setting, style.PUBLISHED_GREY)
        for part, face in ((group[is_success], colour), (group[~is_success], "none")):
            axes.plot(part["voxels"] / 1e6, part["seconds"], linestyle="", marker="o", markersize=5, color=colour,
                      markerfacecolor=face, label=setting if face == colour else None)
    axes.set(xscale="log", yscale="log", xlabel="million voxels", ylabel="seconds of the whole process")
    style.legend(axes, **style.BESIDE)
    cores = ", ".join(str(int(count)) for count in sorted(made["cores"].dropna().unique()))
    style.finish(drawn, f"Each point is one image in one setting, on {cores} threads. Hollow: without success.")
    return drawn


def _rows(frame):
    if frame.empty or "experiment" not in frame:
        return frame.iloc[:0]
    return frame[(frame["experiment"] == EXPERIMENT) & (frame["warmup"] != True)]  # noqa: E712


def _distinct_names(table):
    """Returns the name of each line's image, or its path if images of two folders have that name."""
    paths_of_name = table.groupby("image")["path"].transform("nunique")
    return table["image"].where(paths_of_name == 1, table["path"])


def _line(row):
    outcome, why = _outcome(row)
    verdicts = {name: word for name, word in row.items() if name.startswith("verdicts.") and isinstance(word, str)}
    promised = row.get("promises")
    if isinstance(promised, list):
        verdicts = {name: word for name, word in verdicts.items() if name.removeprefix("verdicts.") in promised}
    size, optimized = row.get("input.size"), row.get("optimization.beyond_bounds")
    path = row.get("input.path")
    return {"path": path if isinstance(path, str) else row["image"], "image": row["image"],
            "setting": row["trial"].partition(",")[0], "mesher": row["mesher"], "outcome": outcome,
            "why": why, "proved": sum(word == "pass" for word in verdicts.values()),
            "promised": len(verdicts), "seconds": row.get("process.wall_s"),
            "memory_mib": row.get("process.peak_rss_bytes", numpy.nan) / 2**20, "cells": row.get("cells", numpy.nan),
            "voxels": float(numpy.prod(size)) if isinstance(size, list) else numpy.nan,
            "beyond_bounds": numpy.nan if optimized is None else optimized, "cores": row.get("cores")}


def _outcome(row):
    """Returns the outcome and its reason. A mesher refuses an image by one sentence and an exit code."""
    if row["status"] == "ok":
        return SUCCESS, ""
    said = [line for line in str(row.get("stderr_tail") or "").splitlines() if line.strip()]
    if row.get("process.exit_code") == EXIT_INPUT and said:
        return REFUSED, said[-1].rpartition(f"{row['image']}: ")[2]
    return FAILED, f"{row['status']}: {row.get('reason') or 'no reason given'}"


def _fixed(value, digits):
    return "" if value is None or value != value else f"{value:.{digits}f}"
