"""Colours of labels and of quality, the same in pictures and pages."""

# For the label of the greatest volume, as a background.
PALE = "#ede3d1"
# Easy to distinguish side by side; muted, so that edges stay visible on them.
PALETTE = ["#cc5c54", "#4582b5", "#f2b854", "#6ba36b", "#9473b3", "#e88c66", "#5cadb0", "#db8fad", "#9e8c59", "#8c9ed1",
           "#b5c769", "#8f575c", "#4d6b78", "#d4c28c", "#b89cc9"]
# Viridis, from matplotlib, at equal steps.
RAMP = ["#440154", "#46327e", "#365c8d", "#277f8e", "#1fa187", "#4ac16d", "#a0da39", "#fde725"]


def colours_of_labels(mesh):
    """Returns a colour per label value: the label's own, otherwise one by rank of volume among all labels."""
    ranked = mesh.labels_by_volume()
    return colours_by_rank(ranked) | {value: mesh.colours[value] for value in ranked if value in mesh.colours}


def colours_by_rank(ranked):
    """Returns a colour per label value. `ranked`: the values, the greatest volume first."""
    if len(ranked) == 1:
        return {ranked[0]: PALETTE[0]}
    return {value: PALE if rank == 0 else _colour(rank - 1) for rank, value in enumerate(ranked)}


def _colour(number):
    """After the last colour the palette repeats lighter, then darker, then from the start."""
    turn, index = divmod(number, len(PALETTE))
    towards, share = ((0, 0), (1, 0.45), (0, 0.4))[turn % 3]
    mixed = (round(255 * ((1 - share) * one + share * towards)) for one in rgb(PALETTE[index]))
    return "#{:02x}{:02x}{:02x}".format(*mixed)


def rgb(colour):
    """Returns three numbers from 0 to 1 for "#rrggbb"."""
    return tuple(int(colour[at:at + 2], 16) / 255 for at in (1, 3, 5))
