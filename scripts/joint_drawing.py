"""Draws docs/figures/joint.svg: journal and bearing, and the letters that go with them."""

import math
import sys

BEARING, JOURNAL = 112.0, 72.0  # radii; the clearance is drawn a hundred times too large
INK, BEARING_INK, JOURNAL_INK, FORCE = "#222", "#8a8f98", "#c9d7ea", "#b03020"
parts = []


def add(text: str) -> None:
    parts.append(text)


def circle(at, radius, **style) -> None:
    add(f'<circle cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="{radius:.1f}" {attributes(style)}/>')


def attributes(style: dict) -> str:
    return " ".join(f'{name.replace("_", "-")}="{value}"' for name, value in style.items())


def line(a, b, arrow: str = "", color: str = INK, width: float = 1.4, dash: str = "") -> None:
    ends = f'marker-end="url(#{arrow})"' if arrow in ("to", "force") else ""
    if arrow == "both":
        ends = 'marker-end="url(#to)" marker-start="url(#from)"'
    dashes = f'stroke-dasharray="{dash}"' if dash else ""
    add(
        f'<line x1="{a[0]:.1f}" y1="{a[1]:.1f}" x2="{b[0]:.1f}" y2="{b[1]:.1f}" '
        f'stroke="{color}" stroke-width="{width}" {dashes} {ends}/>'
    )


def letter(at, text: str, below: str = "", color: str = INK) -> None:
    sub = f'<tspan dy="5" font-size="13">{below}</tspan>' if below else ""
    add(
        f'<text x="{at[0]:.1f}" y="{at[1]:.1f}" font-style="italic" font-size="19" '
        f'fill="{color}" text-anchor="middle">{text}{sub}</text>'
    )


def words(at, text: str, size: int = 14, anchor: str = "middle", weight: str = "normal") -> None:
    add(
        f'<text x="{at[0]:.1f}" y="{at[1]:.1f}" font-size="{size}" fill="{INK}" '
        f'text-anchor="{anchor}" font-weight="{weight}">{text}</text>'
    )


def along(at, angle: float, length: float):
    """A point at a distance, in a direction counter-clockwise from the right (degrees)."""
    a = math.radians(angle)
    return (at[0] + length * math.cos(a), at[1] - length * math.sin(a))


def pair(centre, angle: float, eccentricity: float):
    """Bearing and journal; gives the journal's centre."""
    circle(centre, BEARING + 16, fill=BEARING_INK)
    circle(centre, BEARING, fill="white", stroke=INK, stroke_width=1.4)
    journal = along(centre, angle, eccentricity)
    circle(journal, JOURNAL, fill=JOURNAL_INK, stroke=INK, stroke_width=1.4, fill_opacity=0.8)
    return journal


def dot(at) -> None:
    circle(at, 2.8, fill=INK)


def centred(centre) -> None:
    pair(centre, 0.0, 0.0)
    dot(centre)
    line(centre, along(centre, 150.0, BEARING), "to")
    letter(along(centre, 161.0, 55.0), "R", "b")
    line(centre, along(centre, 60.0, JOURNAL), "to")
    letter(along(centre, 42.0, 48.0), "R", "j")
    line(along(centre, -50.0, JOURNAL), along(centre, -50.0, BEARING), "both")
    letter(along(centre, -36.0, 92.0), "c")
    words((centre[0], centre[1] + 48), "journal", 13)
    words((centre[0], centre[1] - BEARING - 24), "bearing", 13)
    words((centre[0], centre[1] + 165), "centred: the gap is c all round", 15, weight="bold")
    words((centre[0], centre[1] + 187), "c = bearing radius − journal radius", 13)


def flight(centre) -> None:
    journal = pair(centre, 25.0, 36.0)
    line(centre, journal, "to", width=2.4)
    dot(centre)
    letter((centre[0] + 14, centre[1] - 16), "e")
    for at, text, way in [(centre, "bearing centre", 1), (journal, "journal centre", -1)]:
        line((at[0], at[1] + way * 8), (at[0], at[1] + way * 30), width=0.8)
        words((at[0], at[1] + way * 38 + 4), text, 13)
    words((centre[0], centre[1] + 165), "in flight: e &lt; c", 15, weight="bold")
    words((centre[0], centre[1] + 187), "δ = e − c is negative; no force", 13)


def contact(centre) -> None:
    depth = 16.0
    journal = pair(centre, -90.0, BEARING - JOURNAL + depth)
    circle(centre, BEARING, fill="none", stroke=INK, stroke_width=1.4)
    line(centre, (centre[0], centre[1] + BEARING + depth), dash="5 4", width=1.0)
    wall, lowest = centre[1] + BEARING, journal[1] + JOURNAL
    aside = centre[0] - 128
    for level in (wall, lowest):
        line((centre[0], level), (aside - 6, level), width=0.9)
    line((aside, wall - 26), (aside, wall), "to")
    line((aside, lowest + 26), (aside, lowest), "to")
    letter((aside - 16, (wall + lowest) / 2 + 6), "δ")
    line(centre, (centre[0], centre[1] + 38), "to", width=2.4)
    letter((centre[0] - 14, centre[1] + 30), "n")
    line(centre, (centre[0] + 38, centre[1]), "to", width=2.4)
    letter((centre[0] + 50, centre[1] + 4), "t")
    touching = (centre[0], wall)
    line(touching, (centre[0], wall - 52), "force", FORCE, 2.8)
    letter((centre[0] - 20, wall - 34), "F", "N", FORCE)
    line(touching, (centre[0] + 46, wall), "force", FORCE, 2.8)
    letter((centre[0] + 34, wall - 12), "F", "T", FORCE)
    dot(centre)
    dot(journal)
    words((centre[0], centre[1] + 165), "in contact: e &gt; c", 15, weight="bold")
    words((centre[0], centre[1] + 187), "δ = e − c, the depth; forces on the journal", 13)


MARKERS = "".join(
    f'<marker id="{name}" viewBox="0 0 10 10" refX="{at}" refY="5" markerWidth="6" '
    f'markerHeight="6" orient="{way}"><path d="{path}" fill="{color}"/></marker>'
    for name, at, way, path, color in [
        ("to", 9, "auto", "M0,0.8 L10,5 L0,9.2 z", INK),
        ("from", 1, "auto", "M10,0.8 L0,5 L10,9.2 z", INK),
        ("force", 9, "auto", "M0,0.8 L10,5 L0,9.2 z", FORCE),
    ]
)

centred((150, 165))
flight((460, 165))
contact((780, 165))
drawing = "\n".join(parts)
with open(sys.argv[1], "w", encoding="utf-8") as file:
    file.write(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 940 370" width="940" height="370" '
        'font-family="Helvetica, Arial, sans-serif">\n<title>Journal and bearing: radial clearance '
        "c, eccentricity e, depth δ, directions n and t, forces on the journal</title>\n"
        f'<defs>{MARKERS}</defs>\n<rect width="940" height="370" fill="white"/>\n{drawing}\n</svg>\n'
    )
