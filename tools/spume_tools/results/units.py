# SPDX-License-Identifier: MIT
"""Units of what a run records. A run in dimensionless groups has none; one in SI units has these."""
import re

# By the dimension that a table names above its header, or that begins its note.
OF_DIMENSION = {"time": "s", "length": "m", "speed": "m/s", "velocity": "m/s", "pressure": "Pa", "area": "m²",
                "length^2": "m²", "length^3": "m³", "1/time": "1/s", "g/time": "g/s", "g/m3": "g/m³", "g/m3/h": "g/m³/h",
                "g/m3 times length^3": "g", "g/m3 times length^2": "g/m",
                "mass": "kg", "mass times speed": "kg m/s", "1/length": "1/m", "u'": "m/s",
                "of the predicted velocity": "1/s", "velocity^2 length": "m³/s²", "speed at the start of the step": "m/s",
                "speed relative to the resolved liquid": "m/s"}
# By the name of a column, where the note is a formula; and of the fields of snapshots.
OF_NAME = {"kinetic_energy": "J", "potential_energy": "J", "total_energy": "J", "dissipation": "W",
           "unresolved_dissipation": "W", "mean_energy": "m²/s²", "mean_dissipation": "W/kg", "mean_injection": "W/kg",
           "mean_enstrophy": "1/s²", "volume": "m³", "radius": "m", "wavenumber": "1/m", "wall_seconds": "s"}
OF_FIELD = {"speed": "m/s", "velocity": "m/s", "pressure": "Pa", "vorticity": "1/s", "enstrophy": "1/s²",
            "dissipation": "W/kg", "radius": "m"}
# Components of activated sludge, by the names of its model: [biokinetics] demands SI units.
OF_COMPONENT = dict.fromkeys("S_I S_S X_I X_S X_BH X_BA X_P S_O S_NO S_NH S_ND X_ND".split(), "g/m³") | {"S_ALK": "mol/m³"}
# Two-dimensional runs give extensive quantities per metre of depth.
PER_METRE = {"J": "J/m", "W": "W/m", "kg": "kg/m", "kg m/s": "kg/s", "m³": "m²"}
SYMBOL = re.compile(r"(?:[kMGmcµn]?(?:m|s|g|Pa|J|W|N|Hz|K|rad)|1|°C|%)(?:[²³]|\^-?\d)?"
                    r"(?:[ /·](?:[kMGmcµn]?(?:m|s|g|Pa|J|W|N|Hz|K|rad))(?:[²³]|\^-?\d)?)*")


def in_si_units(case):
    """Whether the numbers of a resolved case are SI: as it says, and else where gravity is that of the Earth."""
    if "units" in case:
        return case["units"] == "SI"
    fluid = case.get("fluid", {})
    in_groups = {"reynolds", "froude", "mach"} & fluid.keys()
    return not in_groups and 9.7 <= fluid.get("gravity", 0) <= 9.9


def unit_of(name, note, si=False, dimensions=3):
    """The symbol of a unit, or None: that of a column by its name and the note above the header of its table.

    A note that is a symbol is taken as it is; the name of a dimension stands for its SI unit in a run in SI units.
    """
    note = (note or "").strip()
    if SYMBOL.fullmatch(note):
        return None if note == "1" else note
    if not si:
        return None
    head = re.split("[,:]", note)[0]  # what follows says what is counted
    symbol = OF_DIMENSION.get(note) or OF_NAME.get(name) or OF_DIMENSION.get(head)
    if symbol is None and head != note and SYMBOL.fullmatch(head) and head != "1":
        symbol = head
    return PER_METRE.get(symbol, symbol) if dimensions == 2 else symbol


def field_label(name, si=False):
    """Name and unit of a field of a snapshot, for an axis."""
    if name in OF_COMPONENT:
        return name + (f" [{OF_COMPONENT[name]}]" if si else "")
    whole = name[:-2] if name[-2:] in ("_x", "_y", "_z") else name
    unit = OF_FIELD.get(whole) if si else None
    return name.replace("_", " ") + (f" [{unit}]" if unit else "")
