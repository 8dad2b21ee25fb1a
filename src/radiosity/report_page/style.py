"""The style of the page, on a screen and on paper."""

STYLE = """
:root { color-scheme: light; --line: #c9d1d9; --ink: #1b2430; --soft: #55606e; --band: #f3f6f9; --accent: #0b5394; }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 2rem 1.5rem 4rem; max-width: 60rem; color: var(--ink); background: #fff;
  font: 1rem/1.5 "Segoe UI", "Helvetica Neue", "DejaVu Sans", Arial, sans-serif; }
header { border-bottom: 3px solid var(--accent); padding-bottom: 1rem; margin-bottom: 1.5rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .5rem; overflow-wrap: anywhere; }
h2 { font-size: 1.3rem; margin: 2.2rem 0 .6rem; color: var(--accent); break-after: avoid; }
h3 { font-size: 1.05rem; margin: 1.4rem 0 .4rem; break-after: avoid; overflow-wrap: anywhere; }
p { margin: .5rem 0; }
dl { display: grid; grid-template-columns: minmax(9rem, max-content) 1fr; gap: .25rem 1.2rem; margin: .6rem 0; }
dt { color: var(--soft); } dd { margin: 0; overflow-wrap: anywhere; }
.key { display: grid; grid-template-columns: repeat(auto-fit, minmax(11rem, 1fr)); gap: .8rem; margin: 1rem 0; padding: 0; }
.key div { border: 1px solid var(--line); border-radius: .4rem; padding: .7rem .9rem; break-inside: avoid;
  min-width: 0; overflow-wrap: anywhere; }
.key strong { display: block; font-size: 1.35rem; line-height: 1.25; } .key span { color: var(--soft); font-size: .88rem; }
figure { margin: 1rem 0 1.4rem; break-inside: avoid; } figure img { max-width: 100%; height: auto; display: block; }
figcaption, caption { color: var(--soft); font-size: .92rem; text-align: left; padding: .35rem 0; }
caption { caption-side: top; }
table { border-collapse: collapse; width: 100%; margin: .8rem 0 1.4rem; font-size: .9rem; font-variant-numeric: tabular-nums; }
th, td { padding: .28rem .6rem; border-bottom: 1px solid var(--line); text-align: left; vertical-align: top; }
th { font-weight: normal; }
thead th { font-weight: 600; border-bottom: 2px solid var(--ink); vertical-align: bottom; }
tbody th { overflow-wrap: anywhere; min-width: 12rem; } .short { break-inside: avoid; }
tbody tr:nth-child(even) { background: var(--band); }
.number { text-align: right; white-space: nowrap; } thead .number { white-space: normal; }
tr { break-inside: avoid; } thead { display: table-header-group; }
.note { border-left: 4px solid #b45309; background: #fff7ed; padding: .5rem .9rem; margin: .5rem 0; break-inside: avoid;
  overflow-wrap: anywhere; }
.good { border-color: #15803d; background: #f0fdf4; }
.small { color: var(--soft); font-size: .88rem; }
@media screen { section { overflow-x: auto; } }
@page { size: A4; margin: 18mm 16mm 20mm;
  @bottom-right { content: counter(page) " / " counter(pages); font: 9pt sans-serif; color: #55606e; } }
@media print {
  body { padding: 0; max-width: none; font-size: 10pt; } section.page { break-before: page; }
  section.keep { break-inside: avoid; }
  .views img { max-height: 112mm; } h2 { margin-top: 1.2rem; }
  figure img { max-height: 215mm; } a { color: inherit; }
  .note, .key div, tbody tr { -webkit-print-color-adjust: exact; print-color-adjust: exact; }
}
"""
