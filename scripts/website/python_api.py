"""A page of the Python package podm, made of its sources: signatures and docstrings of the public names."""
import ast
import inspect
import re


def page(folder):
    """`folder`: of the package."""
    package = ast.parse((folder / "__init__.py").read_text(encoding="utf-8"))
    public = next(ast.literal_eval(one.value) for one in package.body
                  if isinstance(one, ast.Assign) and one.targets[0].id == "__all__")
    found = {}
    for path in sorted([*folder.glob("*.py"), *folder.glob("*.pyi")]):
        for one in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(one, (ast.FunctionDef, ast.ClassDef)) and one.name in public:
                found[one.name] = one
    lines = ["# Python API", "", *_prose(ast.get_docstring(package)), ""]
    order = sorted(found, key=lambda name: (not isinstance(found[name], ast.FunctionDef), name))
    for name in order:
        lines += _entry(found[name], "##", name)
        if isinstance(found[name], ast.ClassDef):
            lines += _members(found[name])
    return "\n".join(lines) + "\n"


def _members(one):
    lines = []
    for position, member in enumerate(one.body):
        if isinstance(member, ast.FunctionDef) and not member.name.startswith("_"):
            lines += _entry(member, "###", member.name)
        elif isinstance(member, ast.AnnAssign) and not member.target.id.startswith("_"):
            after = one.body[position + 1] if position + 1 < len(one.body) else None
            lines += [f"### {member.target.id}", "", f"`{member.target.id}: {ast.unparse(member.annotation)}`", ""]
            if isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant):
                lines += [*_prose(inspect.cleandoc(after.value.value)), ""]
    return lines


def _entry(one, marks, name):
    return [f"{marks} {name}", "", *_signature(one), "", *_prose(ast.get_docstring(one) or ""), ""]


def _signature(one):
    if isinstance(one, ast.ClassDef):
        bases = ", ".join(ast.unparse(base) for base in one.bases)
        return [f"`class {one.name}({bases})`" if bases else f"`class {one.name}`"]
    returns = f" -> {ast.unparse(one.returns)}" if one.returns else ""
    if any("property" in ast.unparse(decorator) for decorator in one.decorator_list):
        return [f"`{one.name}`{returns.replace(' -> ', ': `') + '`' if returns else ''}"]
    arguments = [part for part in _arguments(one.args) if part != "self"]
    inline = f"{one.name}({', '.join(arguments)}){returns}"
    if len(inline) < 100:
        return ["```python", inline, "```"]
    return ["```python", f"{one.name}(", *(f"    {part}," for part in arguments), f"){returns}", "```"]


def _arguments(args):
    """One text for each argument, with its type and default."""
    plain = [(one, None) for one in args.args[:len(args.args) - len(args.defaults)]]
    plain += list(zip(args.args[len(args.args) - len(args.defaults):], args.defaults))
    parts = [_argument(*each) for each in plain]
    if args.kwonlyargs:
        parts += ["*", *(_argument(*each) for each in zip(args.kwonlyargs, args.kw_defaults))]
    return parts


def _argument(one, default):
    kind = f": {ast.unparse(one.annotation)}" if one.annotation else ""
    return one.arg + kind + (f" = {ast.unparse(default)}" if default is not None else "")


def _prose(text):
    """A docstring as Markdown: an indented text below a word explains this word, one behind `::` is code."""
    lines, blocks = [], re.split(r"\n{2,}", text.strip())
    is_code = False
    for block in blocks:
        if is_code:
            lines += ["```python", *inspect.cleandoc(block).split("\n"), "```", ""]
        else:
            lines += [*_terms(block.removesuffix(":") if block.endswith("::") else block), ""]
        is_code = block.endswith("::")
    return lines


def _terms(block):
    """The block itself; or, of words with indented texts, a list."""
    lines = block.split("\n")
    if not any(line.startswith("    ") for line in lines) or lines[0].startswith("    "):
        return lines
    made = []
    for line in lines:
        if line.startswith("    "):
            made[-1] += " " + line.strip()
        else:
            made.append(f"- `{line.strip()}`:")
    return made
