"""The page's look, in the light and in the dark."""

from pilotfish.plots.inline_svg import page_colours
from pilotfish.plots.style import DARK, LIGHT

_CSS = """
:root { color-scheme: light dark; --ink: #1b1d22; --dim: #5a5f6b;
  --ground: #ffffff; --panel: #f4f5f7; --grid: #d9dbe0;
  LIGHT_LINES }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e6e6; --dim: #a0a6b3; --ground: #16181d; --panel: #1f2229; --grid: #3a3d45;
    DARK_LINES }
}
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 72rem; padding: 1.5rem; color: var(--ink); background: var(--ground);
  font: 16px/1.5 system-ui, "DejaVu Sans", sans-serif; overflow-wrap: break-word; }
h1 { font-size: 1.7rem; margin: 0 0 .2rem; } h2 { font-size: 1.25rem; margin: 2.2rem 0 .6rem; }
h3 { font-size: 1rem; margin: 1.2rem 0 .4rem; }
p { margin: .3rem 0; } .dim { color: var(--dim); }
nav { display: flex; flex-wrap: wrap; gap: 0 1.2em; } nav a { color: inherit; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: .9rem; }
th, td { text-align: left; padding: .3rem .7rem; border-bottom: 1px solid var(--grid); vertical-align: top; }
th { font-weight: 600; } thead th { background: var(--panel); }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
td.word { overflow-wrap: anywhere; } td.label { white-space: nowrap; }
td details { margin: 0; }
figure { margin: 0 0 1rem; } figure svg { width: 100%; height: auto; max-width: 58rem; display: block; }
figure.small svg { max-width: 40rem; }
figcaption { color: var(--dim); font-size: .9rem; }
pre { background: var(--panel); padding: .8rem; overflow: auto; max-height: 30rem; font-size: .8rem; }
details { margin: .4rem 0; } summary { cursor: pointer; }
.tiles { display: grid; grid-template-columns: repeat(auto-fill, minmax(8.6rem, 1fr)); gap: .7rem; margin: 1rem 0; }
.tile { background: var(--panel); border-radius: .4rem; padding: .6rem .8rem; }
.tile b { display: block; font-size: 1.25rem; white-space: nowrap; font-variant-numeric: tabular-nums; }
.tile.doubt { border-left: 4px solid #d55e00; } .tile .why { color: #b34700; font-size: .85rem; }
@media (prefers-color-scheme: dark) { .tile .why { color: #ff8a4c; } }
.warning { border-left: 4px solid #d55e00; padding: .3rem .8rem; background: var(--panel); }
@media (max-width: 40rem) {
  body { padding: 1rem; } td.label { white-space: normal; } th, td { padding: .3rem .4rem; }
}
@media print { nav { display: none; } pre { max-height: none; } }
"""
CSS = _CSS.replace("LIGHT_LINES", page_colours(LIGHT)).replace("DARK_LINES", page_colours(DARK))
