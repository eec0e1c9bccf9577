"use strict";
// The page of `twinlaw watch`: events come from the server that served it, wishes go back with the token behind # in the address.
const TOKEN = location.hash.slice(1);
const KEPT_S = 65;                       // of rows, a little more than can be shown
const BREAK = 3.5;                       // usual steps: where more rows than three are missing a line ends
const INK = "#1b1f24", SOFT = "#57606a", GRID = "#e3e8ec";
// Okabe and Ito's colours, and a dash of its own for each line, so that nothing rests on colour alone.
const MEASURED = { color: "#0072b2", dash: [], width: 2 };
const PREDICTED = { color: "#d55e00", dash: [7, 3], width: 2 };
const REFERENCE = { color: "#57606a", dash: [2, 3], width: 1.5 };
const PLAIN = [MEASURED, PREDICTED, { color: "#009e73", dash: [2, 3], width: 2 }];

const $ = (id) => document.getElementById(id);
let facts = null, status = null, page = "", charts = [], dirty = true, over = false;
let rows = emptyRows();

function emptyRows() { return { t: [], y: [], u: [], r: [], at: [], p: [], e: [] }; }

// --- what comes ---

function start() {
  if (!TOKEN) return tell("The address is not whole: open the one that `twinlaw watch` printed, with all that stands behind #.");
  const source = new EventSource("/events?token=" + encodeURIComponent(TOKEN));
  source.addEventListener("hello", (event) => meet(JSON.parse(event.data)));
  source.addEventListener("reset", () => { rows = emptyRows(); dirty = true; });
  source.addEventListener("rows", (event) => take(JSON.parse(event.data)));
  source.addEventListener("status", (event) => { status = JSON.parse(event.data); show(); alive(); });
  source.addEventListener("end", () => { over = true; source.close(); lost("`twinlaw watch` has ended"); });
  source.onerror = () => { if (!over) lost("no connection to `twinlaw watch`; a board that this page armed goes safe by itself"); };
}

function lost(text) {
  tell(text);
  $("state").textContent = "not connected";
  $("state").className = "";
  for (const button of document.querySelectorAll("button")) button.disabled = true;
}

function meet(told) {
  facts = told; page = told.page; rows = emptyRows();
  document.title = $("title").textContent = told.title;
  $("who").textContent = told.who;
  tell("");
  build();
  $(told.kind === "log" ? "log" : "board").hidden = false;
  $("link").hidden = told.kind === "log";
  if (told.kind === "log") {
    $("seek").max = told.duration_s;
    $("speed").replaceChildren(...told.speeds.map((speed) => new Option(speed + " x", speed, speed === 1, speed === 1)));
  } else {
    $("fields").replaceChildren(...told.loops.map(field));
  }
}

function field(loop, place) {
  const label = document.createElement("label"), input = document.createElement("input");
  const [low, high] = loop.limits;
  const digits = Math.max(1, 2 - Math.floor(Math.log10(high - low))), whole = 10 ** digits; // a tenth, or a hundredth of a small range
  const [least, most] = [Math.ceil(low * whole) / whole, Math.floor(high * whole) / whole];
  Object.assign(input, { type: "number", step: "any", min: least, max: most, value: Math.min(Math.max(0, least), most), id: "ref" + place });
  label.append(`${loop.label}${loop.unit ? ` [${loop.unit}]` : ""}, ${low.toFixed(digits - 1)} to ${high.toFixed(digits - 1)}`, input);
  return label;
}

function take(news) {
  rows.t.push(...news.t);
  for (const name of ["y", "u", "r"]) news[name].forEach((column, k) => (rows[name][k] ??= []).push(...column));
  rows.at.push(...news.ahead.t);
  news.ahead.p.forEach((column, k) => {
    (rows.p[k] ??= []).push(...column);
    (rows.e[k] ??= []).push(...column.map((value, i) => (value === null || news.ahead.y[k][i] === null) ? null : news.ahead.y[k][i] - value));
  });
  drop(rows.t, [...rows.y, ...rows.u, ...rows.r]);
  drop(rows.at, [...rows.p, ...rows.e]);
  fill("gap", facts.outputs.map((output, k) => [output.label, news.gap[k] == null ? "after 3 s" : number(news.gap[k] * output.factor) + " " + output.unit]));
  dirty = true;
}

function drop(t, columns) {
  const first = t.findIndex((value) => value >= t[t.length - 1] - KEPT_S);
  if (first > 200) for (const column of [t, ...columns]) column.splice(0, first);
}

// --- what goes ---

async function post(path, content) {
  const headers = { "Content-Type": "application/json", "X-Twinlaw-Token": TOKEN, "X-Twinlaw-Page": page };
  return fetch(path, { method: "POST", headers, body: JSON.stringify(content) });
}

async function wish(content) {
  try {
    const answer = await post("/wish", content);
    tell(answer.ok ? "" : (await answer.json()).error);
  } catch { tell("`twinlaw watch` does not answer"); }
}

// An answer to each status, not a timer: a browser slows the timers of a page in the background, but hands it its events.
let answered = 0;
function alive() {
  if (performance.now() - answered < 400) return;
  answered = performance.now();
  post("/alive", {}).catch(() => {});
}

function tell(text) { $("trouble").textContent = text; $("trouble").hidden = !text; }

$("arm").onclick = () => {
  const sure = facts.mode !== "FLYING" || confirm("The rig will move. Is it free and are all hands off?");
  if (sure) wish({ do: "arm" });
};
$("stop").onclick = () => wish({ do: "stop" });
$("manoeuvre").onclick = () => wish({ do: "manoeuvre" });
$("references").onsubmit = (event) => {
  event.preventDefault();
  wish({ do: "reference", deg: facts.loops.map((_, k) => $("ref" + k).valueAsNumber) });
};
$("play").onclick = () => wish({ do: status.playing ? "pause" : "play" });
$("speed").onchange = () => wish({ do: "speed", factor: Number($("speed").value) });
$("seek").onchange = () => wish({ do: "seek", t_s: Number($("seek").value) });
$("span").onchange = () => { dirty = true; };
document.addEventListener("keydown", (event) => {
  if (!facts) return;
  if (event.key === "Escape" && facts.kind === "board") wish({ do: "stop" });
  if (event.key === " " && facts.kind === "log" && event.target === document.body) { event.preventDefault(); $("play").click(); }
});

// --- what stands beside the charts ---

function show() {
  if (facts.kind === "log") return showLog();
  const mine = status.pilot === page, armed = status.armed;
  $("state").textContent = armed ? `armed: ${status.sentence}` : status.sentence;
  $("state").className = armed ? "armed" : "";
  $("arm").disabled = armed;
  $("stop").disabled = false;
  $("refer").disabled = $("manoeuvre").disabled = !(armed && mine);
  $("note").textContent = armed ? (mine ? (status.manoeuvre ? "flying the manoeuvre; references end it" : "this page flies") : "another page flies; stop works here too")
    : (facts.mode === "LOOP" ? "host in the loop: a simulated rig moves, the board's power stage stays off" : "the board flies on its own sensors: the rig moves");
  if (status.trouble) tell(status.trouble);
  showLink();
}

function showLog() {
  $("state").textContent = status.playing ? `replay, ${status.speed} x` : (status.t_s >= facts.duration_s ? "end of the log" : "paused");
  $("state").className = status.playing ? "live" : "";
  $("play").textContent = status.playing ? "Pause" : (status.t_s >= facts.duration_s ? "Again" : "Play");
  $("play").disabled = false;
  $("instant").textContent = `${status.t_s.toFixed(1)} of ${facts.duration_s.toFixed(1)} s`;
  if (document.activeElement !== $("seek")) $("seek").value = status.t_s;
  if (document.activeElement !== $("speed")) $("speed").value = status.speed;
}

function showLink() {
  const board = status.counters, host = status.received;
  if (!("frames_accepted" in board)) return;
  const refused = ["cobs_errors", "too_long", "too_short", "crc_errors", "wrong_version", "unknown_type", "wrong_length"];
  const sum = (from, names) => names.reduce((total, name) => total + (from[name] || 0), 0);
  const uart = sum(board, ["uart_overruns", "uart_framing_errors", "uart_noise_errors", "rx_ring_overflows"]);
  fill("health", [
    ["frames that the board took", board.frames_accepted],
    ["frames that the host took", host.frames],
    ["lost on the way to the board", board.frames_lost, board.frames_lost > 0],
    ["refused by the board", sum(board, refused), sum(board, refused) > 0],
    ["refused by the host", sum(host, refused), sum(host, refused) > 0],
    ["bytes spoiled in the board", uart, uart > 0],
    ["ticks late", board.tick_overruns, board.tick_overruns > 0],
    ["host lost while armed", board.host_losses, board.host_losses > 0],
    ["encoder faults", board.encoder_faults, board.encoder_faults > 0],
    ["round trip", status.round_trip_ms == null ? "–" : status.round_trip_ms.toFixed(2) + " ms"],
    ["control step", status.law_cycles == null ? "–" : status.law_cycles + " cycles"],
  ]);
  fill("counters", Object.entries(board));
}

function fill(id, entries) {
  $(id).tBodies[0].replaceChildren(...entries.map(([name, value, bad]) => {
    const row = document.createElement("tr"), left = row.insertCell(), right = row.insertCell();
    left.textContent = name; right.textContent = value;
    if (bad) right.className = "bad";
    return row;
  }));
}

function number(value) {
  const size = Math.abs(value);
  return size >= 100 ? value.toFixed(0) : size < 1e-3 ? value.toFixed(4) : value.toPrecision(3);
}

// --- charts ---

function build() {
  const scale = (column, factor) => (column || []).map((value) => (value === null ? null : value * factor));
  charts = facts.outputs.map((output, k) => ({
    title: `${output.label}${output.unit ? ` [${output.unit}]` : ""}`,
    lines: () => [
      { name: "reference", style: REFERENCE, t: rows.t, v: scale(rows.r[k], output.factor) },
      { name: "measured", style: MEASURED, t: rows.t, v: scale(rows.y[k], output.factor) },
      { name: "predicted 1 s before", style: PREDICTED, t: rows.at, v: scale(rows.p[k], output.factor) },
    ].filter((line) => line.style !== REFERENCE || facts.referenced.includes(output.name)),
  }));
  for (const unit of new Set(facts.outputs.map((output) => output.unit))) charts.push({
    title: `measured minus predicted${unit ? ` [${unit}]` : ""}`,
    lines: () => facts.outputs.map((output, k) => ({ name: output.label, style: PLAIN[k % 3], t: rows.at, v: scale(rows.e[k], output.factor), unit: output.unit }))
      .filter((line) => line.unit === unit),
  });
  for (const unit of new Set(facts.inputs.map((input) => input.unit))) charts.push({
    title: `inputs${unit ? ` [${unit}]` : ""}`,
    lines: () => facts.inputs.map((input, k) => ({ name: input.label, style: PLAIN[k % 3], t: rows.t, v: scale(rows.u[k], input.factor), unit: input.unit, held: true }))
      .filter((line) => line.unit === unit),
  });
  $("charts").replaceChildren(...charts.map((chart) => {
    const figure = document.createElement("figure"), caption = document.createElement("figcaption");
    chart.canvas = document.createElement("canvas");
    chart.canvas.setAttribute("role", "img");
    chart.canvas.setAttribute("aria-label", chart.title);
    const title = document.createElement("b");
    title.textContent = chart.title;
    caption.append(title, ...chart.lines().map(legend));
    figure.append(caption, chart.canvas);
    return figure;
  }));
}

function legend(line) {
  const entry = document.createElement("span"), name = document.createElement("span");
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg"), path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  svg.setAttribute("viewBox", "0 0 30 10");
  const drawn = { d: "M0 5H30", stroke: line.style.color, "stroke-width": line.style.width, "stroke-dasharray": line.style.dash.join(" "), fill: "none" };
  for (const [key, value] of Object.entries(drawn)) if (value !== "") path.setAttribute(key, value);
  svg.append(path);
  name.textContent = line.name;
  entry.append(svg, name);
  return entry;
}

function ticks(low, high, count) {
  const rough = (high - low) / count, power = 10 ** Math.floor(Math.log10(rough));
  const steps = [0.5, 1, 2, 5, 10].map((factor) => factor * power), place = steps.findIndex((value) => value >= rough);
  // One number on an axis tells no scale: from one step to the next it may be two and a half times too wide.
  const step = multiples(steps[place], low, high).length < 3 ? steps[place - 1] : steps[place];
  return { found: multiples(step, low, high), digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}

function multiples(step, low, high) {
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
  return found;
}

function range(lines, from) {
  let low = Infinity, high = -Infinity;
  for (const { t, v } of lines) for (let k = t.length - 1; k >= 0 && t[k] >= from; k--) {
    if (v[k] === null || v[k] === undefined) continue;
    low = Math.min(low, v[k]); high = Math.max(high, v[k]);
  }
  if (low > high) return [-1, 1];
  const room = Math.max(0.08 * (high - low), 0.02 * Math.max(Math.abs(low), Math.abs(high)), 1e-3);
  return [low - room, high + room];
}

function draw(chart) {
  const canvas = chart.canvas, ratio = devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio); canvas.height = Math.round(height * ratio);
  }
  const pen = canvas.getContext("2d"), lines = chart.lines();
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  const span = Number($("span").value), to = Math.max(rows.t.length ? rows.t[rows.t.length - 1] : 0, span), from = to - span;
  const [low, high] = range(lines, from), left = 52, right = width - 8, top = 6, bottom = height - 22;
  const x = (t) => left + (right - left) * (t - from) / span, y = (v) => bottom - (bottom - top) * (v - low) / (high - low);
  axes(pen, { left, right, top, bottom, from, to, low, high, x, y });
  pen.save();
  pen.beginPath(); pen.rect(left, top, right - left, bottom - top); pen.clip();
  for (const line of lines) trace(pen, line, from, x, y);
  pen.restore();
}

function axes(pen, box) {
  pen.font = "12px system-ui, sans-serif";
  pen.lineWidth = 1; pen.setLineDash([]); pen.strokeStyle = GRID; pen.fillStyle = SOFT;
  const across = ticks(box.from, box.to, 5), up = ticks(box.low, box.high, 4);
  pen.textAlign = "center"; pen.textBaseline = "top";
  across.found.forEach((t, k) => {
    stroke(pen, box.x(t), box.top, box.x(t), box.bottom);
    const last = k === across.found.length - 1;
    if (box.x(t) < box.right - 14 || last) pen.fillText(t.toFixed(across.digits) + (last ? " s" : ""), Math.min(box.x(t), box.right - 16), box.bottom + 5);
  });
  pen.textAlign = "right"; pen.textBaseline = "middle";
  for (const v of up.found) {
    stroke(pen, box.left, box.y(v), box.right, box.y(v));
    pen.fillText(v.toFixed(up.digits), box.left - 6, box.y(v));
  }
  pen.strokeStyle = INK;
  stroke(pen, box.left, box.top, box.left, box.bottom);
  stroke(pen, box.left, box.bottom, box.right, box.bottom);
}

function stroke(pen, x0, y0, x1, y1) { pen.beginPath(); pen.moveTo(x0, y0); pen.lineTo(x1, y1); pen.stroke(); }

function trace(pen, line, from, x, y) {
  const first = Math.max(0, line.t.findIndex((t) => t >= from) - 1);
  pen.beginPath(); pen.strokeStyle = line.style.color; pen.lineWidth = line.style.width; pen.setLineDash(line.style.dash); pen.lineJoin = "round";
  const longest = BREAK * usualStep(line.t, first);
  let down = false;
  for (let k = first; k < line.t.length; k++) {
    if (line.v[k] === null || line.v[k] === undefined) { down = false; continue; }
    // Where rows are missing nothing was measured or predicted, and no line says that it was.
    if (k > first && line.t[k] - line.t[k - 1] > longest) down = false;
    if (down && line.held) pen.lineTo(x(line.t[k]), y(line.v[k - 1]));
    if (down) pen.lineTo(x(line.t[k]), y(line.v[k])); else pen.moveTo(x(line.t[k]), y(line.v[k]));
    down = true;
  }
  pen.stroke();
}

function usualStep(t, first) {
  const steps = [];
  for (let k = Math.max(first + 1, t.length - 200); k < t.length; k++) steps.push(t[k] - t[k - 1]);
  return steps.sort((a, b) => a - b)[Math.floor(steps.length / 2)] ?? 0;
}

function frame() {
  if (dirty && facts) { dirty = false; charts.forEach(draw); }
  requestAnimationFrame(frame);
}

addEventListener("resize", () => { dirty = true; });
start();
frame();
