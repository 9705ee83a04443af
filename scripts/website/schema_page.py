"""A page of a JSON Schema: a table with one line for each key."""
import json

from .options_page import cell

LIMITS = {"minimum": "at least", "exclusiveMinimum": "above", "maximum": "at most", "exclusiveMaximum": "below"}


def page(schema):
    lines = [f"# {schema['title']}", ""]
    if "description" in schema:
        lines += [schema["description"], ""]
    lines += ["`a.b` is the key `b` of the object `a`, `a[]` an entry of the list `a`, `a.*` any other key of `a`.", "",
              "| key | value | meaning | present |", "| --- | --- | --- | --- |",
              *_keys(schema, schema, "")]
    return "\n".join(lines) + "\n"


def _keys(whole, part, before):
    for name, one in part.get("properties", {}).items():
        yield from _lines(whole, one, before + name, "always" if name in part.get("required", ()) else "")
    if isinstance(part.get("additionalProperties"), dict):
        yield from _lines(whole, part["additionalProperties"], f"{before}*", "")


def _lines(whole, one, name, present):
    one = _resolved(whole, one)
    yield f"| `{name}` | {_type(whole, one)} | {cell(one.get('description', ''))} | {present} |"
    for part in [one, *map(lambda each: _resolved(whole, each), one.get("oneOf", []) + one.get("anyOf", []))]:
        yield from _keys(whole, part, f"{name}.")
        if isinstance(part.get("items"), dict):
            yield from _lines(whole, part["items"], f"{name}[]", "")


def _resolved(whole, one):
    """Follows `$ref`; what stands beside it comes first."""
    if "$ref" not in one:
        return one
    target = whole
    for step in one["$ref"].removeprefix("#/").split("/"):
        target = target[step]
    return {**_resolved(whole, target), **{key: value for key, value in one.items() if key != "$ref"}}


def _type(whole, one):
    if "const" in one:
        return f"`{json.dumps(one['const'])}`"
    if "enum" in one:
        return ", ".join(f"`{json.dumps(value)}`" for value in one["enum"])
    choices = one.get("oneOf", []) + one.get("anyOf", [])
    if choices:
        return " or ".join(dict.fromkeys(_type(whole, _resolved(whole, each)) for each in choices))
    kinds = one.get("type", "any")
    words = kinds if isinstance(kinds, str) else " or ".join(kinds)
    limits = [f"{phrase} {one[key]:g}" for key, phrase in LIMITS.items() if key in one]
    return ", ".join([words, *limits])
