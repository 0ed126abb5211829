# SPDX-License-Identifier: MIT
"""Shell completion: `python3 -m spume_tools.completion PROGRAM DIR` writes spume.bash, _spume (zsh) and spume.fish.

Verbs, flags and what they take come from the program's own help, the keys of --set from `spume options`, the cases from
the folder of cases beside this package.
"""
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from .places import CASES

# Sections that may stand several times in a case: --set names one of them by its number.
REPEATED = ("solid", "scalar", "scalar_wall", "body", "liquid", "phase", "region", "wavemaker", "sponge", "inflow", "outflow", "sparger",
            "bubble_cloud", "probe")
# What an argument is, by its name in the help: a case, a section of `spume options`, a folder, a file, a key of --set.
KINDS = {"case": "case", "cases": "case", "section": "section", "dir": "folder", "file": "file", "--set": "key",
         "--output": "folder", "--keep": "folder"}


@dataclass
class Flag:
    names: list  # ["-o", "--output"]
    takes: str  # "" for a flag without a value, else one of KINDS or "value"
    help: str


@dataclass
class Verb:
    name: str
    help: str
    argument: str  # what kind of thing it is called with; "" for none
    flags: list


class Facts:
    """What the completions name."""

    def __init__(self, program):
        def told(*arguments):
            return subprocess.run([str(program), *arguments], capture_output=True, text=True, check=True).stdout

        listed = re.findall(r"^  (\w+)\s{2,}(\S.*)$", told("--help").partition("Subcommands:")[2], re.M)
        self.verbs = [self.verb(name, text, told(name, "--help")) for name, text in listed]
        self.flags = flags_in(told("--help"))
        self.sections, self.keys = options_in(told("options"))
        self.cases = sorted(path.parent.name for path in CASES.glob("*/case.toml"))

    @staticmethod
    def verb(name, text, help_text):
        positional = re.search(r"^Positionals:\s*\n  (\w+)", help_text, re.M)
        return Verb(name, text, KINDS.get(positional[1], "file") if positional else "", flags_in(help_text))

    def words(self, kind):
        return {"case": self.cases, "section": self.sections, "key": self.keys}.get(kind, [])


def flags_in(help_text):
    flags = []
    for names, value, text in re.findall(r"^  (-\S+)(?: ([A-Z]+)\b.*?)?\s{2,}(\S.*)$", help_text, re.M):
        names = names.split(",")
        flags.append(Flag(names, KINDS.get(names[-1], "value") if value else "", text))
    return flags


def options_in(listing):
    """Names of the sections, and the keys as --set takes them."""
    sections, keys, section = [], [], ""
    for line in listing.splitlines():
        heading, option = re.fullmatch(r"\[+([^\]]+)\]+", line), re.match(r"  (\w+) ", line)
        if heading:
            section = heading[1]
            sections.append(section)
        elif option:
            keys.append(".".join([*([section] if section else []), *(["0"] if section in REPEATED else []), option[1]]))
    return sections, keys


def bash(facts):
    def reply(kind):
        words = " ".join(facts.words(kind))
        if kind == "key":
            return f"COMPREPLY=($(compgen -S = -W '{words}' -- \"$word\")); compopt -o nospace"
        if kind in ("case", "section"):
            files = "; COMPREPLY+=($(compgen -f -- \"$word\")); compopt -o filenames" if kind == "case" else ""
            return f"COMPREPLY=($(compgen -W '{words}' -- \"$word\")){files}"
        if kind in ("folder", "file"):
            return f"COMPREPLY=($(compgen -{kind[0] if kind == 'file' else 'd'} -- \"$word\")); compopt -o filenames"
        return ":"

    lines = ["# bash completion of spume", "_spume() {",
             '  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}', "  COMPREPLY=()",
             "  if ((COMP_CWORD == 1)); then",
             f"    COMPREPLY=($(compgen -W '{' '.join([verb.name for verb in facts.verbs] + names_of(facts.flags))}' -- \"$word\"))",
             "    return", "  fi", "  case ${COMP_WORDS[1]}:$before in"]
    for verb in facts.verbs:
        for flag in verb.flags:
            if flag.takes:
                lines.append(f"    {' | '.join(f'{verb.name}:{name}' for name in flag.names)}) {reply(flag.takes)}; return ;;")
    lines += ["  esac", "  case ${COMP_WORDS[1]} in"]
    for verb in facts.verbs:
        lines += [f"    {verb.name})", "      if [[ $word == -* ]]; then",
                  f"        COMPREPLY=($(compgen -W '{' '.join(names_of(verb.flags))}' -- \"$word\"))", "      else",
                  f"        {reply(verb.argument)}", "      fi ;;"]
    return "\n".join([*lines, "  esac", "}", "complete -F _spume spume"]) + "\n"


def names_of(flags):
    return [name for flag in flags for name in flag.names]


def zsh(facts):
    def quoted(text):
        return text.replace("'", "'\\''").replace("[", "\\[").replace("]", "\\]").replace(":", "\\:")

    def action(kind):
        words = f"({' '.join(facts.words(kind))})"
        return {"case": "case:_spume_cases", "section": f"section:{words}", "folder": "folder:_files -/", "file": "file:_files",
                "key": "option:_spume_keys"}.get(kind, f"{kind}: ")

    lines = ["#compdef spume", "", "_spume_cases() {",
             f"  _alternative 'cases:case:({' '.join(facts.cases)})' 'files:file:_files'", "}", "", "_spume_keys() {",
             f"  compadd -S = -- {' '.join(facts.keys)}", "}", "", "_spume() {", "  local -a verbs", "  verbs=("]
    lines += [f"    '{verb.name}:{quoted(verb.help)}'" for verb in facts.verbs]
    lines += ["  )", "  if ((CURRENT == 2)); then",
              "    _describe verb verbs",
              "    _arguments " + " ".join(f"'{name}[{quoted(flag.help)}]'" for flag in facts.flags for name in flag.names),
              "    return", "  fi", "  shift words", "  ((CURRENT--))", "  case $words[1] in"]
    for verb in facts.verbs:
        specs = [f"'{'*' if flag.takes == 'key' else ''}{name}[{quoted(flag.help)}]{':' + action(flag.takes) if flag.takes else ''}'"
                 for flag in verb.flags for name in flag.names]
        if verb.argument:
            specs.append(f"'*:{action(verb.argument)}'")
        lines.append(f"    {verb.name}) _arguments {' '.join(specs)} ;;")
    return "\n".join([*lines, "  esac", "}", "", '_spume "$@"']) + "\n"


def fish(facts):
    def quoted(text):
        return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"

    def values(kind):
        words = " ".join(facts.words(kind))
        return {"folder": "-a '(__fish_complete_directories)'", "file": "-F", "value": "",
                "key": f"-a {quoted(' '.join(key + '=' for key in facts.keys))}"}.get(kind, f"-a {quoted(words)}")

    def flag_line(condition, flag):
        words = [f"-l {name[2:]}" if name.startswith("--") else f"-s {name[1:]}" for name in flag.names]
        value = f" -x {values(flag.takes)}" if flag.takes else ""
        return f"complete -c spume -n {condition} {' '.join(words)}{value} -d {quoted(flag.help)}"

    lines = ["# fish completion of spume", "complete -c spume -f"]
    lines += [flag_line("__fish_use_subcommand", flag) for flag in facts.flags]
    for verb in facts.verbs:
        seen = quoted(f"__fish_seen_subcommand_from {verb.name}")
        lines.append(f"complete -c spume -n __fish_use_subcommand -a {verb.name} -d {quoted(verb.help)}")
        lines += [flag_line(seen, flag) for flag in verb.flags]
        if verb.argument:
            lines.append(f"complete -c spume -n {seen} {values(verb.argument)}")
        if verb.argument == "case":
            lines.append(f"complete -c spume -n {seen} -F")
    return "\n".join(lines) + "\n"


SHELLS = {"spume.bash": bash, "_spume": zsh, "spume.fish": fish}


def main():
    program, folder = Path(sys.argv[1]), Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    facts = Facts(program.resolve())
    for name, write in SHELLS.items():
        (folder / name).write_text(write(facts), encoding="utf-8")


if __name__ == "__main__":
    main()
