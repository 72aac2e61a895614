// The interactive plot: a channel of a trial, measured and predicted, and below it how far off the predictions are.
(function () {
  "use strict";
  const box = document.getElementById("explorer");
  const traces = JSON.parse(document.getElementById("traces").textContent);
  if (!box || !traces.length || !window.uPlot) {
    document.documentElement.classList.remove("js");
    return;
  }
  const NAMES = { before: box.dataset.before || "baseline", after: box.dataset.after || "chosen model" };
  const $ = function (id) { return document.getElementById(id); };
  const pickChannel = $("pick-channel"), pickTrial = $("pick-trial"), plot = $("plot"), readout = $("readout");
  let upper = null, lower = null, current = null, syncing = false;

  function colour(name) {
    return getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
  }
  function unique(values) { return Array.from(new Set(values)); }
  function option(select, value, text) {
    const o = document.createElement("option");
    o.value = value;
    o.textContent = text;
    select.appendChild(o);
  }
  function fillTrials() {
    const before = pickTrial.value;
    pickTrial.replaceChildren();
    const here = traces.filter(function (t) { return t.channel === pickChannel.value; });
    here.forEach(function (t) {
      option(pickTrial, t.trial, t.trial + (t.condition ? " · " + t.condition : "") + (t.held ? " · held out" : ""));
    });
    if (here.some(function (t) { return t.trial === before; })) pickTrial.value = before;
  }
  function residual(trace, name) {
    const scale = trace.sigma || 1;
    return trace.time.map(function (_, i) {
      const p = trace[name][i], m = trace.measured[i];
      return p == null || m == null ? null : (p - m) / scale;
    });
  }
  function axis(label, size) {
    return {
      label: label, labelSize: 20, size: size, space: size > 40 ? 26 : 60, stroke: function () { return colour("quiet"); },
      grid: { stroke: function () { return colour("grid"); }, width: 1 },
      ticks: { stroke: function () { return colour("grid"); }, width: 1 },
    };
  }
  function predicted(label, name, dash) {
    return {
      label: label, show: $("show-" + name).checked, width: 2, dash: dash, spanGaps: false,
      stroke: function () { return colour(name); }, points: { show: false },
    };
  }
  function share(self, other) {
    return function (u, key) {
      if (key !== "x" || syncing || !other()) return;
      syncing = true;
      other().setScale("x", { min: u.scales.x.min, max: u.scales.x.max });
      syncing = false;
    };
  }
  function floor(u) {
    if (!current.sigma) return;
    const top = u.valToPos(2, "y", true), bottom = u.valToPos(-2, "y", true);
    u.ctx.save();
    u.ctx.fillStyle = colour("floor");
    u.ctx.fillRect(u.bbox.left, top, u.bbox.width, bottom - top);
    u.ctx.restore();
  }
  function say() {
    const i = upper.cursor.idx;
    const unit = current.unit ? " " + current.unit : "";
    if (i == null) {
      readout.textContent = current.channel + ", trial " + current.trial + ", " + current.time.length + " samples" +
        (current.held ? ", held out from the fit" : "");
      return;
    }
    const show = function (v) { return v == null ? "–" : Number(v.toPrecision(5)) + unit; };
    const off = function (name) {
      if (!current[name].length || current[name][i] == null || current.measured[i] == null) return "";
      const r = (current[name][i] - current.measured[i]) / (current.sigma || 1);
      return " (off by " + r.toFixed(1) + (current.sigma ? " σ" : unit) + ")";
    };
    readout.textContent = "t = " + current.time[i].toFixed(4) + " s: measured " + show(current.measured[i]) +
      (current.before.length ? ", " + NAMES.before + " " + show(current.before[i]) + off("before") : "") +
      (current.after.length ? ", " + NAMES.after + " " + show(current.after[i]) + off("after") : "");
  }
  function padded(lists, atLeast) {
    let low = -atLeast, high = atLeast;
    lists.forEach(function (list) {
      list.forEach(function (v) { if (v != null) { low = Math.min(low, v); high = Math.max(high, v); } });
    });
    const margin = 0.06 * (high - low) || 1;
    return [low - margin, high + margin];
  }
  function draw() {
    current = traces.find(function (t) { return t.channel === pickChannel.value && t.trial === pickTrial.value; });
    [upper, lower].forEach(function (u) { if (u) u.destroy(); });
    upper = lower = null;
    const width = plot.clientWidth, blank = current.time.map(function () { return null; });
    const of = function (name) { return current[name].length ? current[name] : blank; };
    const left = 64, sync = { key: "trial", scales: ["x", null] };
    const unit = current.unit || "1";
    const top = {
      width: width, height: 300, scales: { x: { time: false } }, legend: { show: false },
      cursor: { sync: sync, drag: { x: true, y: false }, points: { size: 7 } },
      axes: [axis("", 26), axis(current.channel + " [" + unit + "]", left)],
      series: [{}, {
        label: "measured", stroke: function () { return colour("measured"); }, paths: function () { return null; },
        points: { show: true, size: 5, width: 0, fill: function () { return colour("measured") + "99"; } },
      }, predicted(NAMES.before, "before", [7, 4]), predicted(NAMES.after, "after")],
      hooks: { setScale: [share("upper", function () { return lower; })], setCursor: [say] },
    };
    upper = new uPlot(top, [current.time, current.measured, of("before"), of("after")], $("plot-values"));
    const rb = current.before.length ? residual(current, "before") : blank;
    const ra = current.after.length ? residual(current, "after") : blank;
    const under = {
      width: width, height: 170, scales: { x: { time: false }, y: { range: padded([rb, ra], current.sigma ? 3 : 0) } }, legend: { show: false },
      cursor: { sync: sync, drag: { x: true, y: false }, points: { size: 6 } },
      axes: [axis("time [s]", 36), axis(current.sigma ? "off by [σ]" : "off by [" + unit + "]", left)],
      series: [{}, predicted(NAMES.before, "before", [7, 4]), predicted(NAMES.after, "after")],
      hooks: { setScale: [share("lower", function () { return upper; })], drawClear: [floor] },
    };
    lower = new uPlot(under, [current.time, rb, ra], $("plot-residuals"));
    say();
  }
  function step(by) {
    pickTrial.selectedIndex = (pickTrial.selectedIndex + by + pickTrial.options.length) % pickTrial.options.length;
    draw();
  }
  function zoom(factor) {
    const s = upper.scales.x, t = current.time, i = upper.cursor.idx;
    const centre = i == null ? (s.min + s.max) / 2 : t[i], half = (s.max - s.min) * factor / 2;
    upper.setScale("x", { min: Math.max(t[0], centre - half), max: Math.min(t[t.length - 1], centre + half) });
  }
  function whole() { upper.setScale("x", { min: current.time[0], max: current.time[current.time.length - 1] }); }
  function move(by) {
    const n = current.time.length, i = upper.cursor.idx;
    const j = i == null ? 0 : Math.min(n - 1, Math.max(0, i + by));
    const y = current.measured[j] == null ? upper.scales.y.min : current.measured[j];
    upper.setCursor({ left: upper.valToPos(current.time[j], "x"), top: upper.valToPos(y, "y") });
  }
  const KEYS = {
    ArrowLeft: function (e) { move(e.shiftKey ? -10 : -1); }, ArrowRight: function (e) { move(e.shiftKey ? 10 : 1); },
    "+": function () { zoom(0.5); }, "=": function () { zoom(0.5); }, "-": function () { zoom(2); }, "0": whole,
    PageUp: function () { step(-1); }, PageDown: function () { step(1); },
  };
  plot.addEventListener("keydown", function (event) {
    const action = KEYS[event.key];
    if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    action(event);
  });

  box.hidden = false;
  unique(traces.map(function (t) { return t.channel; })).forEach(function (c) { option(pickChannel, c, c); });
  fillTrials();
  const first = traces.findIndex(function (t) { return t.held; });
  if (first >= 0) {
    pickChannel.value = traces[first].channel;
    fillTrials();
    pickTrial.value = traces[first].trial;
  }
  pickChannel.addEventListener("change", function () { fillTrials(); draw(); });
  pickTrial.addEventListener("change", draw);
  $("previous").addEventListener("click", function () { step(-1); });
  $("next-trial").addEventListener("click", function () { step(1); });
  $("zoom-in").addEventListener("click", function () { zoom(0.5); });
  $("zoom-out").addEventListener("click", function () { zoom(2); });
  $("reset").addEventListener("click", whole);
  ["before", "after"].forEach(function (name, i) {
    $("show-" + name).addEventListener("change", function () {
      upper.setSeries(i + 2, { show: this.checked });
      lower.setSeries(i + 1, { show: this.checked });
    });
  });
  document.addEventListener("recolour", function () { if (upper) { upper.redraw(); lower.redraw(); } });
  new ResizeObserver(function () {
    if (upper && plot.clientWidth && plot.clientWidth !== upper.width) {
      upper.setSize({ width: plot.clientWidth, height: 300 });
      lower.setSize({ width: plot.clientWidth, height: 170 });
    }
  }).observe(plot);
  draw();
})();
