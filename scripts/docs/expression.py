"""Values of rows: dotted paths, and arithmetic on them.

Examples: `phases_s.refine`, `cells / seconds`, `sum(labels.cells)`, `ranks.rounds[0].deferred`. A path through a list
applies the rest of the path to every entry.
"""
import ast
import operator

from .errors import DocsError

OPERATORS = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
             ast.USub: operator.neg}
FUNCTIONS = {"sum": sum, "len": len, "min": min, "max": max, "abs": abs}


class Missing(DocsError):
    """A row lacks the value."""


class Expression:
    """`roots`: the first names of all paths in it."""

    def __init__(self, text):
        self.text = text.strip()
        try:
            self._tree = ast.parse(self.text, mode="eval").body
        except SyntaxError:
            raise DocsError(f"'{self.text}' is not a value: paths and arithmetic of paths are") from None
        self.roots = {node.id for node in ast.walk(self._tree) if isinstance(node, ast.Name)} - set(FUNCTIONS)

    def of(self, row):
        return self._value(self._tree, row)

    def _value(self, node, row):
        match node:
            case ast.Constant(value=int() | float() | str()):
                return node.value
            case ast.Name(id=name):
                return self._child(row, name)
            case ast.Attribute(value=parent, attr=name):
                return self._child(self._value(parent, row), name)
            case ast.Subscript(value=parent, slice=ast.Constant(value=place)):
                return self._child(self._value(parent, row), place)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS:
                return OPERATORS[type(op)](self._number(left, row), self._number(right, row))
            case ast.UnaryOp(op=op, operand=operand) if type(op) in OPERATORS:
                return OPERATORS[type(op)](self._number(operand, row))
            case ast.Call(func=ast.Name(id=name), args=[argument]) if name in FUNCTIONS:
                return FUNCTIONS[name](_entries(self._value(argument, row)))
        raise DocsError(f"'{self.text}': '{ast.unparse(node)}' is not a path, number, operator or function of "
                        f"{', '.join(FUNCTIONS)}")

    def _number(self, node, row):
        value = self._value(node, row)
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise Missing(f"'{ast.unparse(node)}' is {value!r}, not a number")
        return value

    def _child(self, parent, name):
        if isinstance(parent, list) and isinstance(name, str):
            return [self._child(entry, name) for entry in parent]
        try:
            return parent[name]
        except (KeyError, IndexError, TypeError):
            raise Missing(f"a row has no '{name}' of '{self.text}'") from None


def _entries(value):
    return list(value.values()) if isinstance(value, dict) else value


FACT = Expression("cells")  # stands for values that do not depend on the machine
