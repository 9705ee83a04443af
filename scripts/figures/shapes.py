"""Tables of rows of experiments/shapes.toml: lines where labels meet, a flat box, thin layers, and CGAL's lines."""
import pandas

from .load import RecordError

def _passed(row):
    """Returns "all" if all promised claims passed, else the reason why the row is not ok."""
    return "all" if row["status"] == "ok" else f"{row['status']}: {row['reason']}"


def _settings(row):
    return {"image": row["input"]["name"], "trial": row["trial"].split(",")[0],
            "threads": row["asked"].get("threads", 1)}


def _of_trials(rows, has_option):
    found = [row for row in rows if has_option(row["asked"]) and not row["warmup"]]
    if not found:
        raise RecordError("no rows of such trials")
    return sorted(found, key=lambda row: (row["input"]["name"], row["trial"], row["repeat"]))


def _without(rows, row, options):
    """Returns the row of the same trial and image without these options, or nothing."""
    def others(of):
        return {key: value for key, value in of["asked"].items() if key not in options}
    same = [other for other in rows if other is not row and others(other) == others(row)
            and other["input"]["sha256"] == row["input"]["sha256"] and other["repeat"] == row["repeat"]]
    return same[0] if same else None


def _ratio(row, base, key="cells"):
    return f"{row[key] / base[key]:.3f}" if base and row.get(key) and base.get(key) else ""


def angles(rows):
    """Mean angle errors of facets at lines of phantom:bubbles, without lines and with them."""
    table = []
    for without, with_lines in zip(rows[::2], rows[1::2]):
        table.append({"size": with_lines["size"], "smoothing, voxels": with_lines["smooth_voxels"],
                      "delta, voxels": with_lines["delta_voxels"], "cells": with_lines["cells"],
                      **{f"{title}, degrees": f"{of[place]['mean_deg']:.2f}"
                         for title, of, place in (("at lines, without", without, "at_lines"),
                                                  ("at lines, with", with_lines, "at_lines"),
                                                  ("elsewhere", with_lines, "away"))},
                      "with over without": f"{with_lines['ratio_of_means']:.3f}"})
    return pandas.DataFrame(table)


def _percent(share):
    return "" if share is None else f"{100 * share:.3f}"


def lines(rows):
    """Lines kept and left out by image and trial, and cells beside the mesh without lines."""
    table = []
    for row in _of_trials(rows, lambda asked: asked.get("lines") and "mesher" not in asked):
        kept, ways = row.get("lines"), row.get("line_distances") or {}
        table.append({**_settings(row), "lines, mm": f"{kept['traced_mm']:.0f}" if kept else "",
                      "kept, %": _percent(kept["share_kept"]) if kept else "",
                      "undecided places": len(kept["undecided"]) if kept else "",
                      "stray, mm": f"{kept['stray_mm']:.1f}" if kept else "",
                      "image near mesh, %": _percent(ways.get("image_to_mesh", {}).get("share_near")),
                      "mesh near image, %": _percent(ways.get("mesh_to_image", {}).get("share_near")),
                      "lines promised": "yes" if kept and kept["is_claimed"] else "no", "cells": row.get("cells"),
                      "cells over without": _ratio(row, _without(rows, row, ("lines",))),
                      "claims": _passed(row), "replay": row["replay"]})
    return pandas.DataFrame(table)


def boxes(rows):
    """Flat boxes by image and trial."""
    table = []
    for row in _of_trials(rows, lambda asked: asked.get("box") == "flat"):
        table.append({**_settings(row), "facets on sides": sum((row.get("facets_of_sides") or {}).values()),
                      "off a plane, ulp": row.get("box_ulps_off"),
                      "facets off their side": row.get("guarantees", {}).get("off_sides", ""),
                      "cells": row.get("cells"), "claims": _passed(row), "replay": row["replay"]})
    return pandas.DataFrame(table)


def thin(rows):
    """Topologies of meshes that keep thin layers by image and trial."""
    table = []
    for row in _of_trials(rows, lambda asked: asked.get("thin") == "keep"):
        kept = row.get("thin_layers") or {}
        table.append({**_settings(row), "components": kept.get("components", ""),
                      "ambiguous places": kept.get("ambiguous_places", ""),
                      "differences at first": kept.get("differences_at_first", ""),
                      "left and listed": len(kept["differences"]) if kept else "",
                      "passes": kept.get("passes", ""), "topology": row.get("verdicts", {}).get("topology", ""),
                      "cells": row.get("cells"), "claims": _passed(row), "replay": row["replay"]})
    return pandas.DataFrame(table)


def peers(rows):
    """podm and other meshers with lines, by image: medians over repeats."""
    table = []
    for row in _of_trials(rows, lambda asked: asked.get("lines") and "mesher" in asked):
        if row["repeat"] != 1:
            continue
        repeats = [other for other in rows if other["trial"] == row["trial"] and other.get("phases_s")]
        ways = row.get("line_distances")
        seconds = [sum(value for phase, value in other["phases_s"].items()
                       if phase not in ("read", "write", "measure")) for other in repeats]
        table.append({"image": row["input"]["name"], "mesher": row["asked"]["mesher"], "cells": row.get("cells"),
                      "lines missing, %": _percent(1 - ways["image_to_mesh"]["share_near"]) if ways else "",
                      "line edges off, %": _percent(1 - ways["mesh_to_image"]["share_near"]) if ways else "",
                      "interface off by up to, mm": row.get("interface_distance_mm"),
                      "seconds": f"{pandas.Series(seconds).median():.2f}" if seconds else "",
                      "end": "" if row["status"] in ("ok", "unmet") else f"{row['status']}: {row['reason'][:80]}"})
    return pandas.DataFrame(table)
