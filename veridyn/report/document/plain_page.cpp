#include "veridyn/report/document/page.hpp"

namespace veridyn::report::internal {

namespace {

constexpr std::string_view kPage = R"html(<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; img-src data:">
<link rel="icon" href="data:,">
<title>@@VERIDYN_TITLE@@</title>
<style>
:root { color-scheme: light dark; --good: light-dark(#11734b, #5fd6a2); --caution: light-dark(#8a5a00, #f2c25f);
  --bad: light-dark(#b3202e, #ff8a8f); --soft: light-dark(#556270, #a3b0bd); --rule: light-dark(#dde2e8, #2b3540); }
body { margin: 0; font: 16px/1.55 system-ui, sans-serif; overflow-wrap: break-word; }
main { max-width: 1000px; margin: 0 auto; padding: 24px 16px; }
h1, h2, h3 { line-height: 1.25; }
.subtitle, .footnote, figcaption, footer, dt { color: var(--soft); font-size: 14px; }
.verdict { --tone: var(--soft); padding: 14px 20px; border: 1px solid var(--rule); border-left: 6px solid var(--tone); border-radius: 8px; }
.verdict h2 { margin: 0 0 8px; }
.word { margin: 0; color: var(--tone); font-weight: 700; text-transform: uppercase; font-size: 13px; }
.good { --tone: var(--good); } .caution { --tone: var(--caution); } .bad { --tone: var(--bad); } .muted, .info { --tone: var(--soft); }
.badge { color: var(--tone); font-weight: 600; white-space: nowrap; }
.facts { display: grid; grid-template-columns: repeat(auto-fill, minmax(180px, 1fr)); gap: 10px 24px; }
dd { margin: 0; }
figure { margin: 20px 0; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: 14px; font-variant-numeric: tabular-nums; }
th, td { padding: 5px 10px; border-bottom: 1px solid var(--rule); text-align: left; }
.right { text-align: right; white-space: nowrap; } .center { text-align: center; }
.callout { padding: 10px 14px; border-left: 4px solid var(--soft); } .warning { border-color: var(--caution); }
ul.callout { padding-left: 32px; }
@media print { .scroll { overflow: visible; } table { font-size: 8pt; } tr, .verdict { break-inside: avoid; } }
</style>
</head>
<body>
<div id="report">@@VERIDYN_STATIC@@</div>
@@VERIDYN_DOCUMENT@@</body>
</html>
)html";

}  // namespace

std::string_view page() { return kPage; }

bool page_has_figures() { return false; }

}  // namespace veridyn::report::internal
