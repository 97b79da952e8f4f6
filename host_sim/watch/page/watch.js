"use strict";
// The page of rigtwin watch: draws what the server's events say, and passes the buttons' requests on. It decides nothing:
// the controller does. Without news every value is shown as stale, and what cannot arrive cannot be asked.
(function () {
  const say = document.body.dataset;
  const count = function () { say.errors = String(Number(say.errors) + 1); };
  window.addEventListener("error", count);
  window.addEventListener("unhandledrejection", count);
  window.addEventListener("securitypolicyviolation", count);

  const token = new URLSearchParams(window.location.search).get("token") || "";
  const server_patience = 2000;  // [ms] without an event: the server sends one each 0.5 s at least
  const sure_for = 3000;         // [ms] in which the second press counts
  const reconnect_after = 1000;  // [ms]
  const history = 31;            // [s]
  const colours = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00"];
  const hidden_at_first = ["zdd_r"];  // of a road without a filter it is large and says little
  const dashes = [[], [7, 3], [2, 2], [9, 3, 2, 3], [], [7, 3]];
  const groups = [
    {title: "Displacement", unit: "mm", scale: 1e3, of: "m", names: ["z_r", "z_w", "z_b"]},
    {title: "Deflection", unit: "mm", scale: 1e3, of: "m", names: ["x_cmd", "x_act", "dz_b", "dz_w"]},
    {title: "Force", unit: "N", scale: 1, of: "N", names: ["F_w", "F", "F_w_c", "F_act"]},
    {title: "Acceleration", unit: "m/s²", scale: 1, of: "m/s²", names: ["zdd_b", "zdd_w", "zdd_r"]},
    {title: "Velocity", unit: "m/s", scale: 1, of: "m/s", names: ["v_b", "v_w", "v_r"]},
  ];
  const place = function (id) { return document.getElementById(id); };
  const make = function (tag, parent, text, kind) {
    const element = document.createElement(tag);
    if (text !== undefined) element.textContent = text;
    if (kind) element.className = kind;
    parent.appendChild(element);
    return element;
  };
  const digits = function (value, many) {
    if (value === null || value === undefined || !isFinite(value)) return "–";
    const size = Math.abs(value);
    if (size >= 999.5 && size < 1e6) return String(Math.round(value)).replace("-", "−");
    return Number(value).toPrecision(many || 3).replace(/e\+?/, "e").replace("-", "−");
  };
  const decimals = function (value, places) {
    return value === null || value === undefined || !isFinite(value) ? "–" : value.toFixed(places).replace("-", "−");
  };

  let setup = null;
  let last = null;       // frame
  let heard_at = 0;      // [ms] of the last frame
  let heard = false;     // anything from this server at all
  let width = 0.005;     // [s] of an interval
  let index = [];        // of each interval
  let low = {}, high = {};
  let events = [];
  let model = null;      // what a diagnosis says
  let panels = [];
  let shown = 10;        // [s]
  let link = "connecting";
  let refused = "";      // why the server has refused the events

  // ---- what comes ----
  const take_traces = function (traces) {
    if (traces.reset) { index = []; low = {}; high = {}; }
    width = traces.width;
    for (const i of traces.i) index.push(i);
    for (const name of Object.keys(traces.low || {})) {
      low[name] = (low[name] || []).concat(traces.low[name]);
      high[name] = (high[name] || []).concat(traces.high[name]);
    }
    const oldest = index.length ? index[index.length - 1] - history / width : 0;
    let gone = 0;
    while (gone < index.length && index[gone] < oldest) ++gone;
    if (gone > 200 || (gone > 0 && traces.reset)) {
      index = index.slice(gone);
      for (const name of Object.keys(low)) { low[name] = low[name].slice(gone); high[name] = high[name].slice(gone); }
    }
  };

  const take_frame = function (frame) {
    heard_at = performance.now();
    heard = true;
    refused = "";
    if (frame.setup !== undefined) { setup = frame.setup; build_panels(); show_setup(); }
    if (frame.events) { events = frame.events; show_events(); }
    if (frame.model) { model = frame.model; show_model(); }
    take_traces(frame.traces);
    last = frame;
    say.frames = String(Number(say.frames) + 1);
    update();
  };

  // ---- the connection ----
  let source = null;
  const connect = function () {
    if (source) source.close();
    source = new EventSource("/events?token=" + encodeURIComponent(token));
    source.onmessage = function (event) { take_frame(JSON.parse(event.data)); };
    source.onerror = function () {
      source.close();
      source = null;
      ask_why();
      window.setTimeout(connect, reconnect_after);
      update();
    };
  };
  // An EventSource does not say why it failed.
  const ask_why = function () {
    fetch("/ask", {method: "POST", headers: {"X-Rigtwin-Token": token}, body: ""}).then(function (response) {
      refused = response.status === 403
        ? "The server was started anew: open the address that rigtwin watch has printed." : "";
      if (response.status === 400 && !source && !heard) refused = "Eight pages watch already: close one of them.";
      update();
    }, function () { refused = ""; });
  };

  const link_now = function () {
    if (!heard) return refused ? "lost" : "connecting";
    if (performance.now() - heard_at > server_patience || !source) return "lost";
    return last.link;
  };

  const link_words = {
    connecting: ["… connecting", ""],
    waiting: ["… waiting for a controller", ""],
    live: ["● live", ""],
    gone: ["✗ no values", "No values from the controller for %s. What is shown is old: the rig may be moving. Stop still asks the controller; the red button at the rig always works."],
    ended: ["■ ended", ""],
    lost: ["✗ no connection", "The connection to rigtwin watch has been lost for %s. What is shown is old, and nothing can be asked from here: use the red button at the rig."],
  };

  // Values of one program above the buttons of another.
  const differs = function () {
    return Boolean(last && last.instance && last.controller && last.instance !== last.controller);
  };
  const other_rig = function () {
    if (differs()) {
      return "The values are those of " + (setup ? setup.rig + " (" + last.instance + ")" : last.instance) + ", the buttons ask another program ("
        + last.controller + "). They are locked; Stop stops that other one. Start rigtwin watch with the --socket or --rig of the rig that you see.";
    }
    if (!last || !last.foreign) return "";
    const f = last.foreign;
    return "A second rig publishes to this port: " + (f.rig || "its name is not known yet") + " (" + (f.instance || f.source)
      + "). It is not shown; rig_controller --publish HOST:PORT sends it to a page of its own.";
  };

  // ---- what is shown ----
  const seconds = function (value) { return value < 10 ? value.toFixed(1) + " s" : Math.round(value) + " s"; };

  const show_link = function () {
    link = link_now();
    say.link = link;
    const silence = link === "lost" ? (performance.now() - heard_at) / 1000
      : last && last.silence !== undefined ? last.silence + (performance.now() - heard_at) / 1000 : 0;
    const words = link_words[link];
    place("link").textContent = words[0] + (link === "gone" ? " for " + seconds(silence) : "");
    const alarm = refused || words[1].replace("%s", seconds(silence)) || other_rig();
    say.locked = other_rig() === "" ? "" : "other-rig";
    place("alarm").hidden = alarm === "";
    if (place("alarm-text").textContent !== alarm) place("alarm-text").textContent = alarm;
    document.body.classList.toggle("stale", link !== "live" && last !== null && last.state !== undefined);
    document.querySelectorAll("[data-ask], [data-any]").forEach(function (button) {
      const reachable = link !== "lost" && link !== "connecting";
      const fits = button.dataset.ask === "stop" ? reachable
        : link === "live" && !differs() && (button.dataset.any !== undefined || (last && last.state === button.dataset.in));
      button.disabled = !fits;
      if (button.disabled) calm(button);
    });
  };

  const show_setup = function () {
    place("rig").textContent = setup ? setup.rig : "No rig yet";
    const into = setup && setup.recording ? ", recording " + setup.recording : "";
    place("kind").textContent = setup ? setup.kind + ", " + setup.sample_rate + " Hz" + into : "";
    place("simulated").hidden = !(setup && setup.simulated);
    document.title = (setup ? setup.rig + " – " : "") + "rigtwin watch";
    if (setup) draw_histogram();
  };

  const reason_of = function (frame) {
    if (link === "ended") return "The controller has ended: " + frame.ended + ".";
    if (frame.reason === "none") return frame.state === "idle" ? "No power. Nothing has ended a run yet." : "";
    if (frame.failed_checks && frame.failed_checks.includes(";")) {
      return "Not armed. All failed checks: " + frame.failed_checks.replace(/_/g, " ") + ".";
    }
    const words = frame.trip.replace(/_/g, " ");
    const then = frame.second_reason !== "none" ? ", then " + frame.second_reason.replace(/_/g, " ") : "";
    return (frame.state === "safe" ? "Ended by " : "The last run ended by ") + words + then + ".";
  };

  const is_orderly = function (reason) { return ["none", "reference_ended", "stop_requested"].includes(reason); };

  // Since the run began, and until its road ends; of a run that is over, how long it took.
  const times_of_run = function () {
    let began = null, ended = null;
    events.forEach(function (event) {
      if (event.state === "running" && (began === null || ended !== null)) { began = event.timestamp; ended = null; }
      if (["safe", "idle", "armed", "ended"].includes(event.state) && began !== null && ended === null) ended = event.timestamp;
    });
    if (began === null) return [];
    const elapsed = Math.max(0, (ended === null ? last.timestamp : ended) - began);
    const facts = [["elapsed", decimals(elapsed, 0) + " s"]];
    if (setup && setup.duration && ended === null) {
      facts.push(["remaining", decimals(Math.max(0, setup.duration - elapsed), 0) + " s"]);
    }
    return facts;
  };

  const show_state = function () {
    if (!last || last.state === undefined) return;
    const stale = link !== "live";
    say.state = last.state;
    say.reason = last.reason;
    place("state").textContent = last.state;
    place("why").textContent = (stale && link !== "ended" ? "STALE. " : "") + reason_of(last);
    const tripped = last.state === "safe" && !is_orderly(last.reason);
    const moves = last.state === "running" || last.state === "ready";
    place("situation").className = "verdict " + (tripped ? "bad" : moves ? "good" : "remark");
    const v = last.values || {};
    const facts = [["power", v.enabled ? "on" : "off"], ["level", decimals(v.level, 2)],
                   ["late periods", String(v.late_periods === undefined ? "–" : v.late_periods)],
                   ["bridged samples", String(v.bridged === undefined ? "–" : v.bridged)]].concat(times_of_run());
    const list = place("facts");
    if (list.childElementCount !== facts.length) {
      list.textContent = "";
      facts.forEach(function (fact) { const pair = make("div", list); make("dt", pair, fact[0]); make("dd", pair); });
    }
    facts.forEach(function (fact, i) { list.children[i].firstElementChild.textContent = fact[0]; });
    facts.forEach(function (fact, i) { list.children[i].lastElementChild.textContent = fact[1]; });
  };

  const peak = function (names) {  // of the last second
    let highest = null;
    const from = index.length ? index[index.length - 1] - 1 / width : 0;
    for (const name of names) {
      if (!low[name]) continue;
      for (let i = index.length - 1; i >= 0 && index[i] > from; --i) {
        if (low[name][i] === null) continue;
        highest = Math.max(highest === null ? 0 : highest, Math.abs(low[name][i]), Math.abs(high[name][i]));
      }
    }
    return highest;
  };

  const bar = function (parent, i, kind) {
    if (parent.children[i]) return parent.children[i];
    const row = make("div", parent, undefined, kind);
    make("span", row);
    make("div", make("div", row, undefined, "track"), undefined, "fill");
    make("span", row);
    return row;
  };
  const set_bar = function (parent, i, kind, name, share, text) {
    const row = bar(parent, i, kind);
    const bounded = Math.max(0, Math.min(1, isFinite(share) ? share : 0));
    row.className = kind + (share >= 1 ? " beyond" : share >= 0.75 ? " near" : "");
    row.children[0].textContent = name;
    row.children[1].firstElementChild.style.width = (100 * bounded).toFixed(1) + "%";
    row.children[2].textContent = text;
  };

  const show_gauges = function () {
    if (!setup || !last.values) return;
    const limits = setup.limits, v = last.values, rows = [];
    const add = function (name, value, limit, text) { if (limit) rows.push([name, value === null ? 0 : value / limit, text]); };
    if (v.energy_taken !== undefined) {
      const ratio = v.energy_taken > 0 ? Math.max(0, v.energy_fed / v.energy_taken) : 0;
      add("Energy", ratio, limits.energy_gain, decimals(ratio, 2) + " of " + digits(limits.energy_gain, 2));
    }
    const force = peak(["F", "F_w"]);
    add("Force", force, limits.force, digits(force === null ? null : force / 1e3) + " of " + digits(limits.force / 1e3) + " kN");
    const travel = peak(["x_cmd", "x_act", setup.kind === "quarter_car" ? "z_r" : "x_cmd"]);
    add("Stroke", travel, limits.stroke / 2, digits(travel === null ? null : travel * 1e3) + " of " + digits(limits.stroke * 500) + " mm");
    const spans = setup.spans_us;
    if (limits.delay && spans) {
      const delay = (spans.age.p999 + spans.step.p999) * 1e-6;
      add("Delay P99.9", delay, limits.delay, digits(delay * 1e3) + " of " + digits(limits.delay * 1e3) + " ms");
    }
    const gauges = place("gauges");
    while (gauges.childElementCount > rows.length) gauges.lastElementChild.remove();
    rows.forEach(function (row, i) { set_bar(gauges, i, "gauge", row[0], row[1], row[2]); });
  };

  const show_ages = function () {
    if (!setup || !last.values) return;
    const limit = setup.limits.sample_age, rows = [];
    for (const name of Object.keys(last.values)) {
      if (name.startsWith("age_")) rows.push([name.slice(4), last.values[name]]);
    }
    if (last.values.late !== undefined) rows.push(["period late", last.values.late]);
    const bars = place("age-bars");
    while (bars.childElementCount > rows.length) bars.lastElementChild.remove();
    rows.forEach(function (row, i) {
      set_bar(bars, i, "age", row[0], row[1] / limit, decimals(row[1] * 1e3, 3) + " of " + digits(limit * 1e3) + " ms");
    });
  };

  const show_counts = function () {
    const c = last.counts;
    const parts = [c.received + " datagrams", (c.lost || 0) + " periods lost before publishing", c.lost_on_the_way + " lost on the way"];
    if (setup && setup.every > 1) parts.push("one period of " + setup.every);
    if (c.malformed) parts.push(c.malformed + " not understood");
    if (c.foreign) parts.push(c.foreign + " of another controller, not shown");
    place("counts").textContent = parts.join(" · ");
  };

  const show_events = function () {
    const list = place("events");
    list.textContent = "";
    events.slice().reverse().forEach(function (event) {
      const item = make("li", list);
      make("time", item, new Date(event.wall).toLocaleTimeString("en-GB"));
      const orderly = event.text === "" || ["reference_ended", "stop_requested"].includes(event.text);
      make("span", item, event.state + (event.text ? ": " + event.text.replace(/_/g, " ") : ""), event.state === "safe" && !orderly ? "trip" : "");
    });
  };

  // What a diagnosis has named; it says nothing of what it has not looked at yet.
  const show_model = function () {
    place("model").hidden = false;
    const since = Math.ceil(model.lacking) + " s of motion";
    const stages = {
      waiting: "Waits for motion: " + since + " until it watches." + (model.waits_for ? " " + model.waits_for : ""),
      learning: "Learns what the model gets wrong: " + since + " until it watches.",
      watching: "Watches: " + model.candidates + " candidates, nothing new in the last tests.",
    };
    if (model.largest > model.level) stages.watching = "Watches: something has begun.";
    say.model = model.error ? "ended" : model.stage;
    place("model-stage").textContent = (model.error ? "Ended: " + model.error + "." : stages[model.stage]) + (model.stop ? " " + model.stop : "");
    const list = place("model-findings");
    list.textContent = "";
    model.findings.slice().reverse().forEach(function (finding) {
      const item = make("li", list, undefined, finding.kind === "returned" ? "" : "wrong");
      make("span", item, finding.text);
      if (finding.cause.shows) make("small", item, finding.cause.shows);
    });
    say.findings = String(model.findings.length);
  };

  // ---- drawing ----
  const build_panels = function () {
    const units = setup ? setup.units || {} : {};
    const wanted = groups.map(function (group) {
      return Object.assign({}, group, {names: group.names.filter(function (name) { return units[name] === group.of; })});
    }).filter(function (group) { return group.names.length > 0; });
    const key = JSON.stringify(wanted);
    if (build_panels.key === key) return;
    build_panels.key = key;
    const parent = place("panels");
    parent.textContent = "";
    panels = wanted.map(function (group) {
      const panel = make("div", parent, undefined, "panel");
      const legend = make("div", panel, undefined, "legend");
      make("b", legend, group.title + " [" + group.unit + "]");
      const canvas = make("canvas", panel);
      canvas.setAttribute("role", "img");
      canvas.setAttribute("aria-label", group.title + ": " + group.names.join(", "));
      const curves = group.names.map(function (name, i) {
        const button = make("button", legend);
        button.type = "button";
        button.setAttribute("aria-pressed", String(!hidden_at_first.includes(name)));
        const mark = make("i", button);
        mark.style.borderTopColor = colours[i];
        mark.style.borderTopStyle = dashes[i].length ? (i === 2 ? "dotted" : "dashed") : "solid";
        make("span", button, name);
        const curve = {name: name, colour: colours[i], dash: dashes[i], visible: !hidden_at_first.includes(name), value: make("output", button)};
        button.addEventListener("click", function () {
          curve.visible = !curve.visible;
          button.setAttribute("aria-pressed", String(curve.visible));
          draw();
        });
        return curve;
      });
      return {canvas: canvas, curves: curves, scale: group.scale, low: 0, high: 0};
    });
  };

  /// The canvas's context in CSS pixels, with its size.
  const prepared = function (canvas) {
    const ratio = window.devicePixelRatio || 1;
    const box = {w: canvas.clientWidth, h: canvas.clientHeight};
    if (canvas.width !== Math.round(box.w * ratio) || canvas.height !== Math.round(box.h * ratio)) {
      canvas.width = Math.round(box.w * ratio);
      canvas.height = Math.round(box.h * ratio);
    }
    const c = canvas.getContext("2d");
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.clearRect(0, 0, box.w, box.h);
    c.font = '11px system-ui, "DejaVu Sans", Arial, sans-serif';
    return {c: c, w: box.w, h: box.h};
  };

  const nice_step = function (span, most) {
    const raw = span / most, power = Math.pow(10, Math.floor(Math.log10(raw)));
    const factor = [1, 2, 5, 10].find(function (f) { return f * power >= raw; });
    return factor * power;
  };

  /// Widens at once and narrows slowly, so that an axis does not tremble.
  const adapt = function (panel, from) {
    let lowest = Infinity, highest = -Infinity;
    for (const curve of panel.curves) {
      if (!curve.visible || !low[curve.name]) continue;
      for (let i = from; i < index.length; ++i) {
        const l = low[curve.name][i], h = high[curve.name][i];
        if (l !== null && l < lowest) lowest = l;
        if (h !== null && h > highest) highest = h;
      }
    }
    if (!(lowest <= highest)) { lowest = -1 / panel.scale; highest = 1 / panel.scale; }
    lowest *= panel.scale;
    highest *= panel.scale;
    const room = Math.max(0.08 * (highest - lowest), 1e-3 * Math.max(Math.abs(lowest), Math.abs(highest)), 1e-3);
    const wanted_low = lowest - room, wanted_high = highest + room;
    const first = panel.low === panel.high;
    panel.low = first || wanted_low < panel.low ? wanted_low : panel.low + 0.03 * (wanted_low - panel.low);
    panel.high = first || wanted_high > panel.high ? wanted_high : panel.high + 0.03 * (wanted_high - panel.high);
  };

  const left = 46, bottom = 14;

  const draw_axes = function (d, panel, is_last) {
    const c = d.c, height = d.h - bottom;
    const step = nice_step(panel.high - panel.low, Math.max(3, height / 22));
    c.lineWidth = 1;
    c.textAlign = "right";
    c.textBaseline = "middle";
    for (let y = Math.ceil(panel.low / step) * step; y <= panel.high; y += step) {
      const pixel = Math.round(height * (panel.high - y) / (panel.high - panel.low)) + 0.5;
      c.strokeStyle = Math.abs(y) < step / 1e3 ? "#999" : "#e4e4e4";
      c.beginPath(); c.moveTo(left, pixel); c.lineTo(d.w, pixel); c.stroke();
      c.fillStyle = "#444";
      if (pixel > 5 && pixel < height - 2) c.fillText(String(Number(y.toPrecision(6))).replace("-", "−"), left - 5, pixel);
    }
    c.textBaseline = "alphabetic";
    const time_step = nice_step(shown, 6);
    for (let t = 0; t <= shown + 1e-9; t += time_step) {
      const pixel = Math.round(d.w - 1 - (d.w - left) * t / shown) + 0.5;
      c.strokeStyle = "#eee";
      c.beginPath(); c.moveTo(pixel, 0); c.lineTo(pixel, height); c.stroke();
      c.fillStyle = "#444";
      c.textAlign = t === 0 ? "right" : "center";
      if (is_last && pixel > left + 12) c.fillText(t === 0 ? "now" : "−" + t + " s", pixel, d.h - 2);
    }
    c.strokeStyle = "#888";
    c.beginPath(); c.moveTo(left + 0.5, 0); c.lineTo(left + 0.5, height); c.stroke();
  };

  const first_shown = function (newest) {
    const wanted = newest - shown / width - 1;
    let from = 0, to = index.length;
    while (from < to) { const middle = (from + to) >> 1; if (index[middle] < wanted) from = middle + 1; else to = middle; }
    return from;
  };

  const draw_curve = function (d, panel, curve, from, newest) {
    const lows = low[curve.name], highs = high[curve.name];
    if (!lows) return;
    const c = d.c, height = d.h - bottom, per_interval = (d.w - left) * width / shown;
    const every = setup ? Math.max(1, setup.every / setup.sample_rate / width) : 1;
    const y = function (value) { return height * (panel.high - value * panel.scale) / (panel.high - panel.low); };
    c.strokeStyle = curve.colour;
    c.lineWidth = 1.5;
    c.setLineDash(curve.dash);
    c.beginPath();
    let before = null, column = null, lowest = 0, highest = 0, going = false;
    const flush = function () {
      if (column === null) return;
      const up = going && before !== null && Math.abs(highest - before) > Math.abs(lowest - before);
      const a = up ? lowest : highest, b = up ? highest : lowest;
      if (going) c.lineTo(column, y(a)); else c.moveTo(column, y(a));
      if (a !== b) c.lineTo(column, y(b));
      before = b;
      going = true;
    };
    for (let i = from; i < index.length; ++i) {
      if (lows[i] === null || lows[i] === undefined) { flush(); column = null; going = false; continue; }
      if (i > from && index[i] - index[i - 1] > 3 * every + 2) { flush(); column = null; going = false; }
      const x = Math.round(2 * (d.w - 1 - (newest - index[i]) * per_interval)) / 2;
      if (column !== null && x === column) {
        lowest = Math.min(lowest, lows[i]);
        highest = Math.max(highest, highs[i]);
        continue;
      }
      flush();
      column = x;
      lowest = lows[i];
      highest = highs[i];
    }
    flush();
    c.stroke();
    c.setLineDash([]);
  };

  const draw_trips = function (d, newest, is_first) {
    const c = d.c, height = d.h - bottom;
    for (const event of events) {
      const x = d.w - 1 - (newest * width - event.timestamp) * (d.w - left) / shown;
      const of_these = index.length > 0 && event.timestamp >= (index[0] - 1) * width;  // not of a controller before
      if (event.state !== "safe" || !of_these || x < left || x > d.w) continue;
      c.strokeStyle = "#222";
      c.setLineDash([4, 3]);
      c.beginPath(); c.moveTo(x, 0); c.lineTo(x, height); c.stroke();
      c.setLineDash([]);
      if (!is_first) continue;
      const text = "safe: " + event.text.replace(/ \(.*/, "").replace(/_/g, " ");
      const fits = x + 6 + c.measureText(text).width < d.w;
      c.textAlign = fits ? "left" : "right";
      c.fillStyle = "#fff";
      const wide = c.measureText(text).width + 4;
      c.fillRect(fits ? x + 3 : x - 3 - wide, 2, wide, 14);
      c.fillStyle = "#222";
      c.fillText(text, fits ? x + 5 : x - 5, 13);
    }
  };

  const draw = function () {
    const newest = index.length ? index[index.length - 1] : 0;
    const from = first_shown(newest);
    panels.forEach(function (panel, p) {
      const d = prepared(panel.canvas);
      if (d.w < 80 || d.h < 30) return;
      adapt(panel, from);
      draw_axes(d, panel, p === panels.length - 1);
      d.c.save();
      d.c.beginPath(); d.c.rect(left, 0, d.w - left, d.h - bottom); d.c.clip();
      for (const curve of panel.curves.slice().reverse()) if (curve.visible) draw_curve(d, panel, curve, from, newest);
      d.c.restore();
      draw_trips(d, newest, p === 0);
      for (const curve of panel.curves) {
        const value = last && last.values ? last.values[curve.name] : undefined;
        curve.value.textContent = value === undefined ? "–" : decimals(value * panel.scale, panel.scale > 1 ? 2 : Math.abs(value) < 100 ? 2 : 0);
      }
    });
    say.drawn = String(panels.length);
  };

  const draw_histogram = function () {
    const d = prepared(place("histogram")), spans = setup.spans_us, c = d.c;
    if (d.w < 80 || !spans) return;
    const rows = [["wake-up", spans.wake_up, colours[0]], ["step", spans.step, colours[1]], ["sample age", spans.age, colours[2]]];
    const lowest = 0.1, decades = 6, height = d.h - bottom, base = 24;  // 0.1 µs … 0.1 s
    const x = function (us) { return base + (d.w - base - 4) * Math.log10(Math.max(us, lowest) / lowest) / decades; };
    let most = 10;
    rows.forEach(function (row) { (row[1].classes || []).forEach(function (k) { most = Math.max(most, k[1]); }); });
    const y = function (n) { return height - (height - 4) * (n > 0 ? Math.log10(n) + 0.3 : 0) / (Math.log10(most) + 0.3); };
    c.lineWidth = 1;
    c.textAlign = "center";
    ["0.1", "1 µs", "10", "100", "1 ms", "10", "100"].forEach(function (text, k) {
      const pixel = Math.round(x(lowest * Math.pow(10, k))) + 0.5;
      c.strokeStyle = "#e4e4e4";
      c.beginPath(); c.moveTo(pixel, 0); c.lineTo(pixel, height); c.stroke();
      c.fillStyle = "#444";
      c.fillText(text, Math.min(pixel, d.w - 12), d.h - 2);
    });
    c.textAlign = "right";
    for (let n = 1; n <= most; n *= n === 1 ? 100 : 100) c.fillText(n === 1 ? "1" : "10" + {2: "²", 4: "⁴", 6: "⁶", 8: "⁸"}[Math.round(Math.log10(n))], base - 3, y(n) + 4);
    rows.forEach(function (row) {
      c.strokeStyle = row[2];
      c.lineWidth = 1.5;
      c.beginPath();
      let right = null;
      (row[1].classes || []).forEach(function (k) {
        const from = x(k[0] / Math.pow(2, 0.25)), to = x(k[0]);
        if (right === null || from - right > 2) { if (right !== null) c.lineTo(right, height); c.moveTo(from, height); }
        c.lineTo(from, y(k[1]));
        c.lineTo(to, y(k[1]));
        right = to;
      });
      if (right !== null) c.lineTo(right, height);
      c.stroke();
    });
    const table = place("spans");
    table.textContent = "";
    const head = make("div", table);
    ["[µs]", "P50", "P99", "max"].forEach(function (text) { make("span", head, text); });
    rows.forEach(function (row) {
      const line = make("div", table);
      const name = make("b", line);
      make("i", name).style.background = row[2];
      name.appendChild(document.createTextNode(row[0]));
      [row[1].p50, row[1].p99, row[1].max].forEach(function (us) { make("span", line, digits(us)); });
    });
  };

  const update = function () {
    show_link();
    if (!last) return;
    show_state();
    show_counts();
    if (link === "live" || Number(say.drawn) === 0) { show_gauges(); show_ages(); draw(); }
    say.requests = String(performance.getEntriesByType("resource").filter(function (entry) {
      return !/\/(events|ask)(\?|$)/.test(entry.name);
    }).length);
  };

  // ---- requests ----
  const calm = function (button) {
    if (!button.classList.contains("sure")) return;
    button.classList.remove("sure");
    button.textContent = button.dataset.label;
  };
  const show_answer = function (text, good) {
    place("answer").textContent = text;
    place("answer").className = good ? "" : "refused";
  };
  const ask = function (request) {
    show_answer("Asked: " + request + " …", true);
    fetch("/ask", {method: "POST", headers: {"X-Rigtwin-Token": token, "Content-Type": "text/plain"}, body: request}).then(function (response) {
      if (!response.ok) return response.text().then(function (text) { show_answer(request + ": " + text.trim(), false); });
      return response.json().then(function (reply) {
        if (!reply.heard) { show_answer(request + ": " + reply.answer, false); return; }
        const answer = JSON.parse(reply.answer);
        show_answer(answer.ok ? request + ": taken, the rig is " + answer.state + "." : "Refused: " + answer.error + ".", answer.ok);
      });
    }).catch(function () { show_answer(request + ": rigtwin watch does not answer. Use the red button at the rig.", false); });
  };
  const press = function (button) {
    if (button.dataset.twice !== undefined && !button.classList.contains("sure")) {
      button.dataset.label = button.textContent;
      button.classList.add("sure");
      button.textContent = "Sure?";
      window.setTimeout(function () { calm(button); }, sure_for);
      return;
    }
    calm(button);
    ask(button.dataset.ask);
  };
  document.querySelectorAll("[data-ask]").forEach(function (button) { button.addEventListener("click", function () { press(button); }); });
  place("level").addEventListener("input", function () { place("level-shown").textContent = Number(place("level").value).toFixed(2); });
  place("level-form").addEventListener("submit", function (event) { event.preventDefault(); ask("level " + place("level").value); });
  place("mark-form").addEventListener("submit", function (event) {
    event.preventDefault();
    const text = place("mark").value.trim();
    if (text === "") return;
    ask("mark " + text);
    place("mark").value = "";
  });
  document.querySelectorAll("[data-window]").forEach(function (button) {
    button.addEventListener("click", function () {
      shown = Number(button.dataset.window);
      document.querySelectorAll("[data-window]").forEach(function (other) { other.setAttribute("aria-pressed", String(other === button)); });
      panels.forEach(function (panel) { panel.low = panel.high = 0; });
      if (last) draw();
    });
  });
  window.addEventListener("resize", function () { if (last) { draw(); if (setup) draw_histogram(); } });

  connect();
  update();
  window.setInterval(update, 250);
})();
