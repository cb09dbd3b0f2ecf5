#pragma once

namespace lamella {

/// The style of pages with cards, tables and charts, light or dark as the reader's system is.
inline constexpr const char* kPageStyle = R"css(
:root{color-scheme:light dark;--ink:#1c2430;--soft:#5b6675;--page:#ffffff;--card:#f4f6f8;--line:#d5dae0;--accent:#2f6fb2;--rest:#b9c6d6;--warn:#9a5b00;--error:#b3261e}
@media (prefers-color-scheme:dark){:root{--ink:#e6eaf0;--soft:#9aa5b3;--page:#14181d;--card:#1d232a;--line:#343c46;--accent:#6aa9e9;--rest:#3f5166;--warn:#f0b45c;--error:#ff8a80}}
body{margin:0 auto;max-width:1060px;padding:24px;font:15px/1.5 system-ui,sans-serif;color:var(--ink);background:var(--page)}
h1{font-size:22px;margin:0}h2{font-size:17px;margin:28px 0 8px}p{margin:4px 0;color:var(--soft)}
.cards{display:grid;grid-template-columns:repeat(auto-fit,minmax(126px,1fr));gap:10px;margin-top:16px}
.card{background:var(--card);border-radius:8px;padding:10px 12px}.card b{display:block;font-size:17px}.card span{color:var(--soft);font-size:13px}
.scroll{overflow-x:auto}table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}
th,td{padding:5px 8px;border-bottom:1px solid var(--line);text-align:right;white-space:nowrap}
th:first-child,td:first-child,td.text,th.text{text-align:left}td.wrap{white-space:normal;text-align:left}th{color:var(--soft);font-weight:500}
.dot{display:inline-block;width:11px;height:11px;border-radius:3px;margin-right:7px;border:1px solid var(--soft)}
svg{width:100%;height:auto;background:var(--card);border-radius:8px}svg text{fill:var(--soft);font:12px system-ui,sans-serif}
.grid{stroke:var(--line)}.halo{fill:none;stroke:var(--ink);stroke-opacity:.45;stroke-width:3.4}.line{fill:none;stroke-width:2}
.laying{fill:var(--accent)}.rest{fill:var(--rest)}.use{stroke:var(--soft);stroke-width:.7}.reload{stroke:var(--error);stroke-width:2}
.key{display:flex;flex-wrap:wrap;gap:4px 18px;color:var(--soft);margin:6px 0;font-size:13px}.warning{color:var(--warn)}.error{color:var(--error)}
)css";

}  // namespace lamella
