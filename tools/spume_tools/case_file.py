# SPDX-License-Identifier: MIT
"""Writes case files."""


def toml_value(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(toml_value, value)) + "]"
    return f'"{value}"' if isinstance(value, str) else repr(value)


def toml_text(case):
    """Sections by name: a mapping is a table, a list of mappings a repeated one; other values stand at the top."""
    head = [f"{key} = {toml_value(value)}" for key, value in case.items() if not isinstance(value, (dict, list))]
    parts = []
    for name, section in case.items():
        for entry in section if isinstance(section, list) else [section] if isinstance(section, dict) else []:
            bar = f"[[{name}]]" if isinstance(section, list) else f"[{name}]"
            parts.append("\n".join([bar, *(f"{key} = {toml_value(value)}" for key, value in entry.items())]))
    return "\n\n".join(["\n".join(head), *parts]) + "\n"
