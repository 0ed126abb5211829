# SPDX-License-Identifier: MIT
"""scene/, run/, view/ and cli/ name no method: neither an identifier nor a text holds the name of a folder in src/methods.

Comments may. A name counts in each of its spellings: les_sph, "les-sph", LesSphOptions, make_les_sph.
"""
import re

from .sources import sources

NAMELESS = ("scene", "run", "view", "cli")
# What is no comment: texts, raw texts, identifiers. Comments and characters are matched to be passed over.
TOKEN = re.compile(r"""//[^\n]*|/\*.*?\*/|(?<!\w)'(?:\\.|[^'\\\n])+'"""
                   r"""|(?P<word>R"(?P<end>[^(\s]*)\(.*?\)(?P=end)"|"(?:\\.|[^"\\\n])*"|[A-Za-z_]\w*)""", re.S)
PART = re.compile(r"[A-Z]?[a-z0-9]+|[A-Z]+(?![a-z])")


def names(root):
    """The methods: folders of src/methods, as tuples of words."""
    return {folder.name: tuple(folder.name.split("_")) for folder in sorted((root / "src" / "methods").glob("*/"))}


def named(token, methods):
    """The method that an identifier or a text names; None when it names none."""
    words = [part.lower() for part in PART.findall(token)]
    for method, parts in methods.items():
        if any(tuple(words[start: start + len(parts)]) == parts for start in range(len(words))):
            return method
    return None


def violations(root):
    """One line per mention."""
    methods = names(root)
    for folder in NAMELESS:
        for base in (root / "include" / "spume" / folder, root / "src" / folder):
            for file in sources(base, (".hpp", ".cpp")):
                text = file.read_text(encoding="utf-8")
                for match in TOKEN.finditer(text):
                    method = named(match["word"], methods) if match["word"] else None
                    if method:
                        line = text.count("\n", 0, match.start()) + 1
                        word = " ".join(match["word"].split())[:60]
                        yield (f"{file.relative_to(root)}:{line}: error: {word} names the method {method}; "
                               f"{folder}/ names none, a method registers what is its own")
