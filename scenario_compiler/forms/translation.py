"""Translates all marked functions to one C file: containers, tables, functions and entries."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from scenario_compiler.forms.arrays import inside_struct
from scenario_compiler.forms.declaration import CONTAINERS, columns_of, containers_in_order, start_of
from scenario_compiler.forms.expressions import OtherFunctions, clearing_name, literal, local_name
from scenario_compiler.forms.language import (
    INT,
    INTS,
    NOTHING,
    REAL,
    REALS,
    Finding,
    FunctionSource,
    Kind,
    Marked,
    NotTranslatableError,
    Signature,
    c_name,
    container_columns,
    impure,
)
from scenario_compiler.forms.statements import Statements, c_type, declared, head

HEADER = Path(__file__).with_name("engine.h")
"""C code for Python's arithmetic and for failures."""


def translated(functions: Iterable[Marked], entries: Sequence[Marked]) -> str:
    """Return the functions as the text of one C file.

    Args:
        functions: All marked functions, in the order of the file.
        entries: Those that are called from outside; each becomes a symbol of the library (see `entry_name`).

    Raises:
        NotTranslatableError: Functions use what the engine's language does not have; it has all findings.
    """
    sources = [FunctionSource.of(function) for function in functions]
    signatures: dict[str, Signature] = {}
    findings: list[Finding] = []
    for source in sources:
        try:
            signatures[source.name] = source.signature
        except NotTranslatableError as broken:
            findings += broken.findings
    if findings:
        raise NotTranslatableError(findings)
    around = OtherFunctions(signatures, frozenset(impure(sources)))
    tables: dict[str, tuple[object, ...]] = {}
    bodies = []
    for source in sources:
        statements = Statements(source, around, tables)
        bodies.append(statements.translated())
        findings += statements.findings
    if findings:
        raise NotTranslatableError(sorted(set(findings), key=lambda one: (one.file, one.line, one.rule)))
    parts = [
        "/* The engine, translated from its marked functions. */",
        HEADER.read_text(encoding="utf-8"),
        *(_container(argument) for argument in containers_in_order()),
        *(_clearing(argument) for argument in containers_in_order() if CONTAINERS[argument].written),
        *_several(signatures.values()),
        *(f"{head(source)};" for source in sources),
        *(_table(name, table, signatures) for name, table in tables.items()),
        *bodies,
        '#line 1 "entries"',
        *(_entry(one, signatures[c_name(one)]) for one in entries),
    ]
    return "\n".join(parts) + "\n"


def entry_name(function: Marked) -> str:
    """Return the symbol of an entry in the library."""
    return f"enter_{function.__name__}"


def _container(argument: str) -> str:
    """Return the C struct of a container: columns, addresses of other columns, lengths, as in `arrays.laid_out`."""
    columns = container_columns(argument)
    inside = inside_struct(CONTAINERS[argument].columns)
    lines = [f"    {c_type(columns[name])} {local_name(name)}[{size}];" for name, size in inside.items()]
    lines += [f"    {c_type(kind)} *{local_name(name)};" for name, kind in columns.items() if name not in inside]
    lines += [f"    int64_t {local_name(name)}_size;" for name in columns]
    return "\n".join(["typedef struct {", *lines, f"}} {CONTAINERS[argument].columns.__name__};", ""])


def _clearing(argument: str) -> str:
    """Return the C function that sets a container's columns to their declared start."""
    columns = CONTAINERS[argument].columns
    lines = [f"static void {clearing_name(argument)}({declared(argument, argument)})", "{"]
    for name, column in columns_of(columns).items():
        if not column.kept:
            at = f"{argument}->{local_name(name)}"
            lines.append(f"    for (int64_t k = 0; k < {at}_size; k++)")
            lines.append(f"        {at}[k] = {literal(start_of(columns, name)).text};")
    return "\n".join([*lines, "}"]) + "\n"


def _several(signatures: Iterable[Signature]) -> list[str]:
    """Return the C structs of results that consist of several numbers."""
    results = sorted({one.result for one in signatures if isinstance(one.result, tuple)})
    return [
        "typedef struct {\n"
        + "".join(f"    {c_type(part)} part_{place};\n" for place, part in enumerate(result))
        + f"}} {c_type(result)};\n"
        for result in results
    ]


def _table(name: str, table: tuple[object, ...], signatures: dict[str, Signature]) -> str:
    """Return the C of a table: an array for numbers, for functions a function that calls the one with a given index."""
    if not callable(table[0]):
        kind = REAL if isinstance(table[0], float) else INT
        values = ", ".join(repr(value) for value in table)
        array, text = f"{name}_values", "Reals" if kind == REAL else "Ints"
        return (
            f"static {c_type(kind)} {array}[] = {{{values}}};\n"
            f"static const {text} {name} = {{{array}, {len(table)}}};\n"
        )
    functions: list[Marked] = [one for one in table if callable(one)]
    signature = signatures[c_name(functions[0])]
    names = list(signature.arguments)
    arguments = ", ".join(declared(kind, one) for one, kind in signature.arguments.items())
    result = declared(signature.result, name)
    returning = "" if signature.result == NOTHING else "return "
    lines = [f"static {result}(int64_t which, {arguments})", "{", "    switch (which) {"]
    for number, function in enumerate(functions):
        call = f"{c_name(function)}({', '.join(names)})"
        lines.append(f"    case {number}: {returning}{call};" + ("" if returning else " return;"))
    return "\n".join([*lines, "    }", "    fail(FAIL_INDEX, HERE);", "}", ""])


def _entry(function: Marked, signature: Signature) -> str:
    """Return the C function of an entry, which takes addresses and numbers and returns 1 if it failed, otherwise 0."""
    taken = ["Failure *failure"]
    given = []
    for name, kind in signature.arguments.items():
        if kind in (INTS, REALS):
            taken += [f"{'double' if kind == REALS else 'int64_t'} *{name}", f"int64_t {name}_size"]
            given.append(f"({c_type(kind)}){{{name}, {name}_size}}")
        else:
            taken.append(declared(kind, name))
            given.append(name)
    result: Kind = signature.result
    call = f"{c_name(function)}({', '.join(given)})"
    if result != NOTHING:
        taken.append(declared(result, "*result"))
        call = f"*result = {call}"
    return f"""EXPORT int32_t {entry_name(function)}({", ".join(taken)})
{{
    jmp_buf here;
    way_out = &here;
    failed = failure;
    if (setjmp(here) != 0)
        return 1;
    {call};
    return 0;
}}
"""
