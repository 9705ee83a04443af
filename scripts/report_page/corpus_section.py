"""The section of the page about a corpus of images: rates, the worst images, every image, seconds over voxels."""
from html import escape

from figures import corpus

from .html import fold, table_html

HOW = "No corpus was run: make corpus FOLDER=FOLDER meshes every label image of a folder."


def corpus_html(outcome, figure):
    """`figure`: the HTML of the figure."""
    if "corpus" not in outcome.tables:
        return f'<p class="faint">{HOW}</p>'
    table = outcome.tables["corpus"][0]
    parts = [f"<p>{escape(corpus.summary(table))}</p>",
             table_html(corpus.readable_rates(corpus.rates(table)), "Images by setting and outcome"),
             f'<p class="faint">{escape(f"{corpus.NOTE} {corpus.why_without_rows(table)}".strip())}</p>', figure,
             fold("The worst ten: without success, then by seconds per voxel",
                  table_html(corpus.readable(corpus.worst(table)), "The worst ten")),
             fold(f"All {len(table)} rows", table_html(outcome.tables["corpus"][1], "All images"), False)]
    return "\n".join(parts)
