"use strict";
// Draws what the payload holds. Every number shown was computed before the page was made.
(() => {
  const payload = JSON.parse(document.getElementById("payload").textContent);
  const element = (id) => document.getElementById(id);
  const buffer = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
  const floats = (text) => new Float32Array(buffer(text));
  const BLUE = "#0072B2", ORANGE = "#E69F00", GREEN = "#009E73", RED = "#D55E00", GREY = "#7F7F7F";

  // ---- data -------------------------------------------------------------------------------
  const angles = payload.angles.map(floats);
  const time = Array.from(floats(payload.time));
  const frequency = Array.from(floats(payload.frequency));
  const preload = payload.preload;
  const scaled = {}, branches = {}, layers = {};
  for (const [name, item] of Object.entries(payload.histories)) {
    scaled[name] = {
      values: new Uint16Array(buffer(item.values)), low: floats(item.low), scale: floats(item.scale),
    };
  }
  for (const [name, text] of Object.entries(payload.branches)) branches[name] = floats(text);
  for (const [key, item] of Object.entries(payload.layers)) {
    const own = item.angles.map(floats);
    layers[key] = { ...item, angles: own, values: floats(item.values), categories: Object.keys(item.meanings).map(Number) };
  }
  const outcomes = new Int8Array(buffer(payload.outcome.values));
  const ends = new Int8Array(buffer(payload.end.values));

  const cellOf = (pair) => pair[0] * angles[1].length + pair[1];
  const history = (name, cell) => {
    const { values, low, scale } = scaled[name];
    const length = values.length / low.length;
    return Array.from(values.subarray(cell * length, (cell + 1) * length), (v) => low[cell] + scale[cell] * v);
  };
  const branch = (name, cell, mode) => {
    const length = branches[name].length / (2 * angles[0].length * angles[1].length);
    return Array.from(branches[name].subarray((2 * cell + mode) * length, (2 * cell + mode + 1) * length));
  };
  const nearest = (grid, value) => {
    let best = 0;
    grid.forEach((item, i) => { if (Math.abs(item - value) < Math.abs(grid[best] - value)) best = i; });
    return best;
  };
  const layerValue = (layer, pair) => {
    const [i, j] = [0, 1].map((axis) => nearest(layer.angles[axis], angles[axis][pair[axis]]));
    return layer.values[i * layer.angles[1].length + j];
  };
  // An angle as a fraction of π, for instance 5π/6; the grid's angles all have a small one.
  const fraction = (angle, pi) => {
    const part = angle / Math.PI;
    for (let below = 1; below <= 60; below += 1) {
      const above = Math.round(part * below);
      if (Math.abs(part * below - above) > 1e-5) continue;
      if (above === 0) return "0";
      return `${above === 1 ? "" : above}${pi}${below === 1 ? "" : `/${below}`}`;
    }
    return `${+part.toFixed(4)}${pi}`;
  };
  const written = (layer, value) => {
    if (Number.isNaN(value)) return "none";
    if (layer.categories.length) return layer.meanings[value];
    const rounded = Math.abs(value) < 1e-9 ? "0" : value.toPrecision(4);
    return `${rounded} ${layer.unit}`.trim();
  };

  // ---- plots ------------------------------------------------------------------------------
  const coarse = matchMedia("(pointer: coarse)").matches;
  const config = { responsive: true, displaylogo: false, displayModeBar: coarse ? false : "hover" };
  const frame = (x, y, more = {}) => ({
    margin: { l: 52, r: 12, t: 8, b: 42 }, dragmode: coarse ? false : "zoom", showlegend: false,
    font: { size: 12 }, hovermode: "closest",
    xaxis: { title: { text: x }, zeroline: false, ...(more.xaxis || {}) },
    yaxis: { title: { text: y }, zeroline: false, ...(more.yaxis || {}) },
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
    const rows = Array.from(a2, (_, j) => Array.from(a1, (__, i) => {
      const value = layer.values[i * a2.length + j];
      return category ? position.get(value) : value;
    }));
    const text = category ? rows.map((row) => row.map((place) => layer.meanings[layer.categories[place]])) : undefined;
    const count = layer.categories.length;
    const steps = layer.categories.flatMap((code, place) => [
      [place / count, layer.colours[code]], [(place + 1) / count, layer.colours[code]],
    ]);
    const ticks = [0, 0.25, 0.5, 0.75, 1].map((part) => part * Math.PI);
    const axis = { tickvals: ticks, ticktext: ["0", "π/4", "π/2", "3π/4", "π"], range: [-0.05, Math.PI + 0.05], constrain: "domain" };
    const heat = {
      type: "heatmap", x: Array.from(a1), y: Array.from(a2), z: rows, text,
      hovertemplate: category ? "%{text}<extra></extra>" : `%{z:.4g} ${layer.unit}<extra></extra>`,
      colorbar: { thickness: 12, orientation: "h", y: -0.22, yanchor: "top", x: 0.5, len: 1, title: { text: category ? "" : layer.unit } },
      ...(category
        ? { colorscale: steps, zmin: -0.5, zmax: count - 0.5, showscale: false }
        : { colorscale: "Viridis", zmin: layer.range[0], zmax: layer.range[1] }),
    };
    const cross = {
      type: "scatter", mode: "markers", x: [0], y: [0], hoverinfo: "skip",
      marker: { symbol: "circle-open", size: 15, color: "#ffffff", line: { width: 5 } },
    };
    const ring = { ...cross, marker: { symbol: "circle-open", size: 15, color: RED, line: { width: 2.5 } } };
    const layout = frame("α₁ (rad)", "α₂ (rad)", {
      xaxis: axis, yaxis: { ...axis, scaleanchor: "x" },
      layout: { dragmode: false, margin: { l: 52, r: 10, t: 6, b: category ? 42 : 112 } },
    });
    element("note").replaceChildren(...legend(layer));
    return Plotly.react("map", [heat, cross, ring], layout, { ...config, displayModeBar: false }).then(markMap);
  }

  function legend(layer) {
    if (!layer.categories.length) return [document.createTextNode(layer.note)];
    return layer.categories.flatMap((code) => {
      const swatch = document.createElement("span");
      swatch.style.cssText = `display:inline-block;width:0.9em;height:0.9em;border:1px solid #555;vertical-align:-0.1em;background:${layer.colours[code]}`;
      return [swatch, document.createTextNode(` ${layer.meanings[code]}   `)];
    });
  }

  function markMap() {
    const [x, y] = [0, 1].map((axis) => [angles[axis][chosen[axis]]]);
    return Plotly.restyle("map", { x: [x, x], y: [y, y] }, [1, 2]);
  }

  function drawForce(cell) {
    const force = history("normalized_contact_force", cell);
    Plotly.react("force", [line(time, force, BLUE), dot(RED)],
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
    const pivots = { type: "scatter", mode: "markers", hoverinfo: "skip", x: ends.map((e) => e[0]), y: ends.map((e) => e[1]), marker: { color: "#1a1a1a", size: 8, symbol: "square" } };
    const traces = [
      line(x, y, "#9a9a9a", { line: { color: "#9a9a9a", width: 1 } }),
      line([-1e4, 1e4], [belt, belt], "#1a1a1a", { hoverinfo: "skip", line: { color: "#1a1a1a", width: 3 } }),
      pivots,
      line([], [], BLUE, { hoverinfo: "skip" }), line([], [], ORANGE, { hoverinfo: "skip" }), line([], [], GREY, { hoverinfo: "skip" }),
      dot("#1a1a1a", 13),
    ];
    Plotly.react("orbit", traces, frame("x (m)", "y (m)", {
      xaxis: { range: xRange }, yaxis: { range: yRange, scaleanchor: "x" },
    }), config);
    showInstant();
  }

  function showInstant() {
    const k = Number(element("instant").value);
    const mass = [orbit.x[k], orbit.y[k]];
    const touching = orbit.force[k] > 0;
    const springs = orbit.ends.map((end) => coil(mass, end, orbit.width, 7));
    const contact = coil(mass, [mass[0], touching ? orbit.belt : mass[1] - orbit.foot], 0.6 * orbit.width, 4);
    Plotly.restyle("orbit", {
      x: [springs[0].x, springs[1].x, contact.x, [mass[0]]],
      y: [springs[0].y, springs[1].y, contact.y, [mass[1]]],
      "line.color": [BLUE, ORANGE, touching ? GREEN : RED, "#1a1a1a"],
    }, [3, 4, 5, 6]);
    Plotly.restyle("force", { x: [[time[k]]], y: [[orbit.force[k]]] }, [1]);
    element("clock").textContent = `t = ${time[k].toFixed(1)}${touching ? "" : ", apart"}`;
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
    element("command").textContent = `squealpipe simulate ${picked.map((a) => fraction(a, "pi")).join(" ")}`;
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
    drawForce(cell); drawSpectrum(cell); drawBackbones(cell); drawOrbit(cell);
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
    button.textContent = `Fig ${scene.figure}: ${scene.angles.map((a) => fraction(a, "π")).join(", ")}`;
    button.addEventListener("click", () => choose(pairAt(scene.angles)));
    if (pairAt(scene.angles).every((place, axis) => Math.abs(angles[axis][place] - scene.angles[axis]) < 0.03)) element("scenes").append(button);
  }

  const fromAddress = window.location.hash.slice(1).split(",").map((part) => Number(part) * Math.PI);
  const start = fromAddress.length === 2 && fromAddress.every(Number.isFinite) ? fromAddress : [5 * Math.PI / 6, 5 * Math.PI / 6];
  drawMap().then((map) => {
    element("map").on("plotly_click", (event) => choose(pairAt([event.points[0].x, event.points[0].y])));
    return choose(pairAt(start));
  }).then(() => {
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) play(true);
    document.body.dataset.ready = "true";
  });
})();
