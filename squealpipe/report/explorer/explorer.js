"use strict";
// Draws what the payload holds. Every number shown was computed before the page was made.
(() => {
  const payload = JSON.parse(document.getElementById("payload").textContent);
  const element = (id) => document.getElementById(id);
  const buffer = (text) => {
    const raw = atob(text), bytes = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; i += 1) bytes[i] = raw.charCodeAt(i);
    return bytes.buffer;
  };
  const floats = (text) => new Float32Array(buffer(text));
  const GREEN = "#009E73", RED = "#D55E00", GREY = "#7F7F7F";
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  let BLUE, ORANGE, INK, LINE, PAPER;
  const readColours = () => { [BLUE, ORANGE, INK, LINE, PAPER] = ["first", "second", "ink", "line", "paper"].map(colour); };
  readColours();

  // ---- data -------------------------------------------------------------------------------
  // Numbers wait as text in blocks of the page and are decoded for what is shown alone.
  const angles = payload.angles;
  const cells = angles[0].length * angles[1].length;
  const texts = {};
  const block = (name) => { texts[name] ??= element(`data-${name}`).textContent; return texts[name]; };
  const record = (name, cell) => {
    const text = block(name), length = text.length / cells;
    return buffer(text.slice(cell * length, (cell + 1) * length));
  };
  const time = Array.from(floats(payload.time));
  const frequency = Array.from(floats(payload.frequency));
  const preload = payload.preload;
  const layers = {};
  for (const [key, item] of Object.entries(payload.layers)) {
    layers[key] = { ...item, key, categories: Object.keys(item.meanings).map(Number) };
  }
  const valuesOf = (layer) => floats(block(`layer-${layer.key}`));
  const outcomes = new Int8Array(buffer(payload.outcome.values));
  const ends = new Int8Array(buffer(payload.end.values));

  const cellOf = (pair) => pair[0] * angles[1].length + pair[1];
  const history = (name, cell) => {
    const data = record(name, cell);
    const [low, scale] = new Float32Array(data, 0, 2);
    return Array.from(new Uint16Array(data, 8), (value) => low + scale * value);
  };
  const branch = (name, cell, mode) => {
    const both = new Float32Array(record(name, cell));
    return Array.from(both.subarray(mode * payload.points, (mode + 1) * payload.points));
  };
  const nearest = (grid, value) => {
    let best = 0;
    grid.forEach((item, i) => { if (Math.abs(item - value) < Math.abs(grid[best] - value)) best = i; });
    return best;
  };
  const layerValue = (layer, pair) => {
    const [i, j] = [0, 1].map((axis) => nearest(layer.angles[axis], angles[axis][pair[axis]]));
    // Three bytes are four letters: the six bytes around the value's four.
    const at = 4 * (i * layer.angles[1].length + j), first = Math.floor(at / 3);
    const bytes = buffer(block(`layer-${layer.key}`).slice(4 * first, 4 * first + 8));
    return new DataView(bytes).getFloat32(at - 3 * first, true);
  };
  // An angle as a fraction of π, for instance 5π/6; the grid's angles all have a small one.
  const fraction = (angle, pi, digits = 4) => {
    const part = angle / Math.PI;
    for (let below = 1; below <= 60; below += 1) {
      const above = Math.round(part * below);
      if (Math.abs(part * below - above) > 1e-12 * below) continue;
      if (above === 0) return "0";
      return `${above === 1 ? "" : above}${pi}${below === 1 ? "" : `/${below}`}`;
    }
    return `${+part.toPrecision(digits)}${pi}`;
  };
  const written = (layer, value) => {
    if (Number.isNaN(value)) return "none";
    if (layer.categories.length) return layer.meanings[value];
    const rounded = Math.abs(value) < 1e-9 ? "0" : value.toPrecision(4);
    return `${rounded} ${layer.unit}`.trim();
  };

  // ---- plots ------------------------------------------------------------------------------
  const coarse = matchMedia("(pointer: coarse)").matches;
  const config = {
    responsive: true, displaylogo: false, displayModeBar: coarse ? false : "hover",
    showSendToCloud: false, showEditInChartStudio: false,
    modeBarButtonsToRemove: ["sendDataToCloud", "editInChartStudio", "lasso2d", "select2d"],
  };
  const frame = (x, y, more = {}) => ({
    margin: { l: 52, r: 12, t: 8, b: 42 }, dragmode: coarse ? false : "zoom", showlegend: false,
    font: { size: 12, color: INK }, hovermode: "closest",
    paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
    modebar: { bgcolor: "rgba(0,0,0,0)", color: GREY, activecolor: INK },
    xaxis: { title: { text: x }, zeroline: false, gridcolor: LINE, ...(more.xaxis || {}) },
    yaxis: { title: { text: y }, zeroline: false, gridcolor: LINE, ...(more.yaxis || {}) },
    ...(more.layout || {}),
  });
  const line = (x, y, color, more = {}) => ({ type: "scatter", mode: "lines", x, y, line: { color, width: 1.4 }, ...more });
  const dot = (color, size = 9) => ({ type: "scatter", mode: "markers", x: [0], y: [0], hoverinfo: "skip", marker: { color, size } });

  let chosen = [0, 0];
  let orbit = null;

  function drawMap() {
    const layer = layers[element("layer").value];
    const [a1, a2] = layer.angles;
    const category = layer.categories.length > 0;
    const position = new Map(layer.categories.map((code, place) => [code, place]));
    const values = valuesOf(layer);
    const rows = Array.from(a2, (_, j) => Array.from(a1, (__, i) => {
      const value = values[i * a2.length + j];
      return category ? position.get(value) : value;
    }));
    const [first, second] = [a1, a2].map((own, axis) => own.map((angle) => `α${"₁₂"[axis]} = ${fraction(angle, "π")}`));
    const text = rows.map((row, j) => row.map((place, i) => (
      `${first[i]}, ${second[j]}${category ? `<br>${layer.meanings[layer.categories[place]]}` : ""}`)));
    const count = layer.categories.length;
    const steps = layer.categories.flatMap((code, place) => [
      [place / count, layer.colours[code]], [(place + 1) / count, layer.colours[code]],
    ]);
    const ticks = [0, 0.25, 0.5, 0.75, 1].map((part) => part * Math.PI);
    const axis = { tickvals: ticks, ticktext: ["0", "π/4", "π/2", "3π/4", "π"], range: [-0.05, Math.PI + 0.05], constrain: "domain" };
    const heat = {
      type: "heatmap", x: Array.from(a1), y: Array.from(a2), z: rows, text,
      hovertemplate: category ? "%{text}<extra></extra>" : `%{text}<br>%{z:.4g} ${layer.unit}<extra></extra>`,
      colorbar: { thickness: 12, orientation: "h", y: -0.22, yanchor: "top", x: 0.5, len: 1, title: { text: category ? "" : layer.unit } },
      ...(category
        ? { colorscale: steps, zmin: -0.5, zmax: count - 0.5, showscale: false }
        : { colorscale: "Viridis", zmin: layer.range[0], zmax: layer.range[1] }),
    };
    const cross = {
      type: "scatter", mode: "markers", ...mark(), hoverinfo: "skip",
      marker: { symbol: "circle-open", size: 15, color: "#ffffff", line: { width: 5 } },
    };
    const ring = { ...cross, marker: { symbol: "circle-open", size: 15, color: RED, line: { width: 2.5 } } };
    const layout = frame("α₁ (rad)", "α₂ (rad)", {
      xaxis: axis, yaxis: { ...axis, scaleanchor: "x" },
      layout: { dragmode: false, margin: { l: 52, r: 10, t: 6, b: category ? 42 : 112 } },
    });
    element("note").replaceChildren(...legend(layer));
    return Plotly.react("map", [heat, cross, ring], layout, { ...config, displayModeBar: false });
  }

  function legend(layer) {
    if (!layer.categories.length) return [document.createTextNode(layer.note)];
    return layer.categories.map((code) => {
      const entry = document.createElement("span");
      entry.style.cssText = "display:inline-block;margin-right:0.8em";
      const swatch = document.createElement("span");
      swatch.style.cssText = `display:inline-block;width:0.9em;height:0.9em;border:1px solid #555;vertical-align:-0.1em;background:${layer.colours[code]}`;
      entry.append(swatch, ` ${layer.meanings[code]}`);
      return entry;
    });
  }

  function mark() {
    const [x, y] = [0, 1].map((axis) => [angles[axis][chosen[axis]]]);
    return { x, y };
  }

  function markMap() {
    const { x, y } = mark();
    return Plotly.restyle("map", { x: [x, x], y: [y, y] }, [1, 2]);
  }

  function drawForce(cell) {
    const force = history("normalized_contact_force", cell);
    Plotly.react("force", [line(time, force, BLUE), { ...dot(RED), x: [time[0]], y: [force[0]] }],
      frame("t (s)", "N / (k₃ l_pre)", { yaxis: { rangemode: "tozero" } }), config);
  }

  function drawSpectrum(cell) {
    const natural = ["omega1_contact", "omega2_contact"].filter((key) => key in layers)
      .map((key) => layerValue(layers[key], chosen)).filter((value) => value > 0);
    const shapes = natural.map((value) => ({
      type: "line", x0: value, x1: value, yref: "paper", y0: 0, y1: 1, line: { color: GREY, dash: "dot", width: 1.5 },
    }));
    Plotly.react("spectrum", [line(frequency, history("force_spectrum", cell), BLUE)],
      frame("ω (rad/s)", "amplitude", { yaxis: { rangemode: "tozero" }, layout: { shapes } }), config);
  }

  function drawBackbones(cell) {
    const traces = [], reasons = [];
    [BLUE, ORANGE].forEach((color, mode) => {
      const omega = branch("omega", cell, mode);
      const reason = payload.end.meanings[ends[2 * cell + mode]];
      if (omega.some(Number.isNaN)) { reasons.push(`mode ${mode + 1}: none (${reason})`); return; }
      reasons.push(`mode ${mode + 1} ends: ${reason}`);
      const index = branch("stability_index", cell, mode);
      const marker = { size: 6, symbol: index.map((v) => (Math.abs(v) > 2 ? "circle-open" : "circle")), color };
      const shared = { type: "scatter", x: omega, showlegend: true };
      traces.push({ ...shared, mode: "lines+markers", y: branch("y_peak", cell, mode), name: `mode ${mode + 1}: y peak`, line: { color }, marker });
      traces.push({ ...shared, mode: "lines", y: branch("x_amplitude", cell, mode), name: `mode ${mode + 1}: x amplitude`, line: { color, dash: "dash" } });
    });
    const shapes = [{ type: "line", xref: "paper", x0: 0, x1: 1, y0: preload, y1: preload, line: { color: GREY, width: 1.5 } }];
    Plotly.react("backbones", traces, frame("ω (rad/s)", "displacement (m)", {
      yaxis: { rangemode: "tozero" },
      layout: { shapes, showlegend: true, legend: { orientation: "h", y: 1.02, yanchor: "bottom" }, margin: { l: 52, r: 12, t: 50, b: 42 } },
    }), config);
    element("ends").textContent = reasons.join("; ");
  }

  // ---- the mechanism ----------------------------------------------------------------------
  function coil(from, to, width, turns) {
    const along = [to[0] - from[0], to[1] - from[1]];
    const length = Math.hypot(...along) || 1;
    const across = [-along[1] / length * width, along[0] / length * width];
    const x = [from[0]], y = [from[1]];
    for (let k = 0; k <= 2 * turns; k += 1) {
      const part = 0.15 + 0.7 * k / (2 * turns), side = k === 0 || k === 2 * turns ? 0 : (k % 2 ? 1 : -1);
      x.push(from[0] + part * along[0] + side * across[0]);
      y.push(from[1] + part * along[1] + side * across[1]);
    }
    return { x: [...x, to[0]], y: [...y, to[1]] };
  }

  function drawOrbit(cell) {
    const [x, y] = ["x", "y"].map((name) => history(name, cell));
    const [a1, a2] = [0, 1].map((axis) => angles[axis][chosen[axis]]);
    const [l1, l2] = payload.lengths;
    const ends = [[l1 * Math.cos(a1), l1 * Math.sin(a1)], [-l2 * Math.cos(a2), l2 * Math.sin(a2)]];
    // L3 is not part of the model; the drawn spring is longer than it is ever compressed.
    const foot = Math.max(2.2 * preload, 1.2 * (preload - Math.min(...y))), belt = preload - foot;
    const reach = (values, fixed) => {
      const all = [...values, ...fixed, 0];
      const low = Math.min(...all), high = Math.max(...all), pad = 0.06 * (high - low) + 0.4 * preload;
      return [low - pad, high + pad];
    };
    const xRange = reach(x, ends.map((end) => end[0])), yRange = reach(y, [...ends.map((end) => end[1]), belt]);
    orbit = { x, y, ends, foot, belt, width: 0.03 * (xRange[1] - xRange[0]), force: history("normalized_contact_force", cell) };
    const pivots = { type: "scatter", mode: "markers", hoverinfo: "skip", x: ends.map((e) => e[0]), y: ends.map((e) => e[1]), marker: { color: INK, size: 8, symbol: "square" } };
    const { springs, contact, mass, colours } = mechanism(0);
    const spring = (points, color) => line(points.x, points.y, color, { hoverinfo: "skip" });
    const traces = [
      line(x, y, "#9a9a9a", { line: { color: "#9a9a9a", width: 1 } }),
      line([-1e4, 1e4], [belt, belt], "#1a1a1a", { hoverinfo: "skip", line: { color: INK, width: 3 } }),
      pivots,
      spring(springs[0], colours[0]), spring(springs[1], colours[1]), spring(contact, colours[2]),
      { ...dot(INK, 13), x: [mass[0]], y: [mass[1]] },
    ];
    Plotly.react("orbit", traces, frame("x (m)", "y (m)", {
      xaxis: { range: xRange }, yaxis: { range: yRange, scaleanchor: "x" },
    }), config);
    tell(0);
  }

  function mechanism(k) {
    const mass = [orbit.x[k], orbit.y[k]];
    const touching = orbit.force[k] > 0;
    const springs = orbit.ends.map((end) => coil(mass, end, orbit.width, 7));
    const contact = coil(mass, [mass[0], touching ? orbit.belt : mass[1] - orbit.foot], 0.6 * orbit.width, 4);
    return { springs, contact, mass, colours: [BLUE, ORANGE, touching ? GREEN : RED] };
  }

  function tell(k) {
    element("clock").textContent = `t = ${time[k].toFixed(1)}${orbit.force[k] > 0 ? "" : ", apart"}`;
  }

  function showInstant() {
    const k = Number(element("instant").value);
    const { springs, contact, mass, colours } = mechanism(k);
    Plotly.restyle("orbit", {
      x: [springs[0].x, springs[1].x, contact.x, [mass[0]]],
      y: [springs[0].y, springs[1].y, contact.y, [mass[1]]],
      "line.color": [...colours, INK],
    }, [3, 4, 5, 6]);
    Plotly.restyle("force", { x: [[time[k]]], y: [[orbit.force[k]]] }, [1]);
    tell(k);
  }

  // ---- choosing ---------------------------------------------------------------------------
  function choose(pair) {
    chosen = pair.map((place, axis) => Math.min(Math.max(place, 0), angles[axis].length - 1));
    const cell = cellOf(chosen);
    ["alpha1", "alpha2"].forEach((id, axis) => {
      element(id).value = chosen[axis];
      element(`${id}-text`).textContent = `= ${fraction(angles[axis][chosen[axis]], "π")}`;
    });
    const picked = [0, 1].map((axis) => angles[axis][chosen[axis]]);
    element("command").textContent = `squealpipe simulate ${picked.map((a) => fraction(a, "pi", 17)).join(" ")} ${payload.options}`.trim();
    const facts = Object.values(layers).map((layer) => [layer.label, written(layer, layerValue(layer, chosen))]);
    facts.push(["run shown", payload.outcome.meanings[outcomes[cell]]]);
    element("facts").replaceChildren(...facts.map(([label, value]) => {
      const row = document.createElement("tr"), head = document.createElement("th"), item = document.createElement("td");
      head.scope = "row"; head.textContent = label; item.textContent = value;
      row.append(head, item);
      return row;
    }));
    window.history.replaceState(null, "", `#${picked.map((a) => +(a / Math.PI).toFixed(4)).join(",")}`);
    element("instant").value = 0;
    drawForce(cell); drawOrbit(cell);
    drawSpectrum(cell); drawBackbones(cell);
    return markMap();
  }

  const pairAt = (values) => values.map((value, axis) => nearest(angles[axis], value));

  // ---- animation --------------------------------------------------------------------------
  let playing = false, started = 0, shown = 0;
  const unitsPerSecond = 5;
  function tick(now) {
    if (!playing) return;
    if (now - shown > 33) {
      shown = now;
      const t = ((now - started) / 1000 * unitsPerSecond) % time[time.length - 1];
      element("instant").value = Math.round(t / time[time.length - 1] * (time.length - 1));
      showInstant();
    }
    requestAnimationFrame(tick);
  }
  function play(on) {
    playing = on;
    element("play").textContent = on ? "Pause" : "Play";
    started = performance.now() - time[Number(element("instant").value)] / unitsPerSecond * 1000;
    if (on) requestAnimationFrame(tick);
  }

  // ---- wiring -----------------------------------------------------------------------------
  ["alpha1", "alpha2"].forEach((id, axis) => {
    element(id).max = angles[axis].length - 1;
    element(id).addEventListener("input", () => choose(chosen.map((place, k) => (k === axis ? Number(element(id).value) : place))));
  });
  element("instant").max = time.length - 1;
  element("instant").addEventListener("input", () => { play(false); showInstant(); });
  element("play").addEventListener("click", () => play(!playing));
  element("layer").addEventListener("change", drawMap);
  element("map").addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] }[event.key];
    if (!step) return;
    event.preventDefault();
    choose(chosen.map((place, axis) => place + step[axis]));
  });
  for (const scene of payload.scenes) {
    const button = document.createElement("button");
    button.type = "button";
    // The button says the pair that it opens: of the grid, the one nearest to the paper's.
    const opened = pairAt(scene.angles);
    button.textContent = `Fig ${scene.figure}: ${opened.map((place, axis) => fraction(angles[axis][place], "π")).join(", ")}`;
    button.addEventListener("click", () => choose(opened));
    if (opened.every((place, axis) => Math.abs(angles[axis][place] - scene.angles[axis]) < 0.03)) element("scenes").append(button);
  }

  dark.addEventListener("change", () => { readColours(); drawMap().then(() => choose(chosen)); });

  const fromAddress = window.location.hash.slice(1).split(",").map((part) => Number(part) * Math.PI);
  const start = fromAddress.length === 2 && fromAddress.every(Number.isFinite) ? fromAddress : [5 * Math.PI / 6, 5 * Math.PI / 6];
  chosen = pairAt(start);
  drawMap().then(() => {
    element("map").on("plotly_click", (event) => choose(pairAt([event.points[0].x, event.points[0].y])));
    // The browser shows the map before the panels are drawn.
    setTimeout(() => {
      choose(chosen);
      document.body.dataset.ready = "true";
      if (!matchMedia("(prefers-reduced-motion: reduce)").matches) play(true);
    });
  });
})();
