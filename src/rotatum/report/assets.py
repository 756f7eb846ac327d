"""The report's looks: style sheet, the script that draws, light and dark templates."""

from __future__ import annotations

import json

__all__ = ["SCRIPT", "STYLE", "templates"]

STYLE = """
:root { --ink: #1c2733; --soft: #55636f; --ground: #f4f6f8; --card: #fff; --edge: #dde3e8;
  --warn: #fff4e0; --warn-edge: #e69f00; }
@media (prefers-color-scheme: dark) { :root { --ink: #e4e9ee; --soft: #9fadba; --ground: #12171c;
  --card: #1b2229; --edge: #313b45; --warn: #2e2515; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 20px; max-width: 1500px; color: var(--ink);
  background: var(--ground); font: 15px/1.5 system-ui, "Segoe UI", Roboto, sans-serif; }
h1 { font-size: 1.5rem; margin: .2em 0 .5em; } h2 { font-size: 1.2rem; margin: 1.2em 0 .4em; }
h3 { font-size: 1rem; margin: 0 0 .2em; }
header, main, footer { overflow-wrap: anywhere; }
.answers, .papers { list-style: none; padding: 0; margin: .4em 0; }
.answers li { margin: .35em 0; } header .answers { font-size: 1.1rem; }
.papers li { margin: .5em 0; } .papers em { color: var(--soft); }
.badge { color: #111; border-radius: 4px; padding: .1em .5em; font-size: .82rem;
  font-weight: 600; vertical-align: .08em; white-space: nowrap; }
.note { color: var(--soft); font-size: .86rem; margin: .4em 0; }
.reason { margin: .3em 0; }
.cards { display: grid; grid-template-columns: minmax(0, 1fr); gap: 16px; margin: 14px 0; }
@media (min-width: 1100px) { .cards { grid-template-columns: repeat(2, minmax(0, 1fr)); }
  .card.stiffness { grid-column: 1 / -1; } .card.tall { grid-row: span 2; } }
.card { background: var(--card); border: 1px solid var(--edge); border-radius: 8px;
  padding: 12px 14px; min-width: 0; }
.plot { width: 100%; }
.wide { overflow-x: auto; margin: .6em 0; }
table { border-collapse: collapse; font-size: .86rem; background: var(--card); }
th, td { border: 1px solid var(--edge); padding: .3em .5em; text-align: left;
  vertical-align: top; overflow-wrap: normal; }
th { color: var(--soft); font-weight: 600; } .results td { white-space: pre; }
.fitted td { white-space: nowrap; }
.events td:nth-child(2) { text-align: right; }
.warnings { background: var(--warn); border-left: 4px solid var(--warn-edge);
  padding: .2em 1em .4em; border-radius: 4px; margin: 1em 0; }
.warnings h2 { margin: .4em 0; font-size: 1rem; }
.warnings ul { margin: .3em 0; padding-left: 1.2em; }
nav { display: flex; flex-wrap: wrap; gap: 8px; margin: .6em 0; }
nav a { border: 1px solid var(--edge); border-radius: 16px; padding: .15em .8em;
  background: var(--card); color: inherit; text-decoration: none; }
.keys { display: flex; flex-wrap: wrap; gap: 4px 16px; font-size: .86rem; margin: .2em 0; }
.keys i { display: inline-block; width: .9em; height: .9em; border-radius: 2px;
  margin-right: .4em; vertical-align: -.08em; }
details { margin: .6em 0; } summary { cursor: pointer; color: var(--soft); }
@media (max-width: 600px) { body { padding: 12px; } .card { padding: 10px 6px; }
  .card h3, .card p, .card .wide { margin-left: 6px; margin-right: 6px; } }
@media print { body { background: #fff; } .card { break-inside: avoid; } }
"""

# Zooming into the time of one plot zooms into that of all plots of the same joint.
SCRIPT = """
(function () {
  "use strict";
  const templates = JSON.parse(document.getElementById("templates").textContent);
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  const template = () => (dark.matches ? templates.dark : templates.light);
  const plots = [];
  let linking = false;
  function link(from, change) {
    const range = change["xaxis.range[0]"] !== undefined
      ? [change["xaxis.range[0]"], change["xaxis.range[1]"]] : null;
    if (linking || !(range || change["xaxis.autorange"])) { return; }
    linking = true;
    const section = from.closest("section");
    const others = plots.filter(
      (p) => p !== from && p.dataset.time && p.closest("section") === section);
    Promise.all(others.map((p) => Plotly.relayout(p, range
      ? { "xaxis.range": range } : { "xaxis.autorange": true }))).then(() => { linking = false; });
  }
  document.querySelectorAll("script[data-plot]").forEach((script) => {
    const place = document.getElementById(script.dataset.plot);
    const figure = JSON.parse(script.textContent);
    figure.layout.template = template();
    const titles = Object.keys(figure.layout).filter((k) => k.startsWith("xaxis"))
      .map((k) => ((figure.layout[k].title || {}).text || ""));
    if (titles.some((text) => text.startsWith("time"))) { place.dataset.time = "1"; }
    Plotly.newPlot(place, figure.data, figure.layout,
      { responsive: true, displayModeBar: false });
    new ResizeObserver(() => Plotly.Plots.resize(place)).observe(place);
    if (place.dataset.time) { place.on("plotly_relayout", (change) => link(place, change)); }
    plots.push(place);
  });
  dark.addEventListener("change", () => plots.forEach((p) =>
    Plotly.relayout(p, { template: template() })));
  document.documentElement.dataset.ready = String(plots.length);
}());
"""


def templates() -> str:
    """Return plotly's templates of both colour schemes as JSON: {"light": ..., "dark": ...}."""
    light = _template(ink="#1c2733", grid="#e3e8ec", edge="#b8c2cb")
    dark = _template(ink="#dfe6ec", grid="#2f3943", edge="#56626e")
    return json.dumps({"light": light, "dark": dark})


def _template(ink: str, grid: str, edge: str) -> dict[str, object]:
    axis = {
        "gridcolor": grid,
        "linecolor": edge,
        "showline": True,
        "ticks": "outside",
        "ticklen": 3,
        "tickcolor": edge,
        "automargin": True,
        "exponentformat": "power",
        "title": {"standoff": 6, "font": {"size": 12}},
    }
    layout = {
        "font": {"color": ink, "size": 11, "family": "system-ui, Segoe UI, Roboto, sans-serif"},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
        "xaxis": axis,
        "yaxis": axis,
        "hoverlabel": {"font": {"size": 11}},
    }
    return {"layout": layout}
