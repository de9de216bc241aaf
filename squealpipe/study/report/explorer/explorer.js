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
  const valuesOf = (layer) => {
    const data = buffer(block(`layer-${layer.key}`));
    return layer.categories.length ? new Int8Array(data) : new Float32Array(data);
  };
  const outcomes = new Int8Array(buffer(payload.outcome.values));
  const ends = payload.end && new Int8Array(buffer(payload.end.values));

  const cellOf = (pair) => pair[0] * angles[1].length + pair[1];
  const history = (name, cell) => {
    const data = record(name, cell);
    const [low, scale] = new Float32Array(data, 0, 2);
    return Array.from(new Uint16Array(data, 8), (value) => low + scale * value);
  };
  const branch = (name, cell, mode) => {
    const both = new Float32Array(record(name, cell));
    return Array.from(both.subarray(mode * both.length / 2, (mode + 1) * both.length / 2));
  };
  const nearest = (grid, value) => {
    let best = 0;
    grid.forEach((item, i) => { if (Math.abs(item - value) < Math.abs(grid[best] - value)) best = i; });
    return best;
  };
  const layerValue = (layer, pair) => {
    const [i, j] = [0, 1].map((axis) => nearest(layer.angles[axis], angles[axis][pair[axis]]));
    // Three bytes are four letters: the six bytes around the value's one or four.
    const wide = layer.categories.length ? 1 : 4, at = wide * (i * layer.angles[1].length + j), first = Math.floor(at / 3);
    const bytes = new DataView(buffer(block(`layer-${layer.key}`).slice(4 * first, 4 * first + 8)));
    return wide === 1 ? bytes.getInt8(at - 3 * first) : bytes.getFloat32(at - 3 * first, true);
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
    const rounded = Math.abs(value) < 1e-9 ? "0" : value.toPrecision(4).replaceAll("-", "−");
    return `${rounded} ${layer.unit}`.trim();
  };

  // ---- plots ------------------------------------------------------------------------------
  const charts = Object.fromEntries(["map", "force", "orbit", "spectrum", "backbones"].filter(element).map((id) => [id, chart(element(id))]));
  const axesOf = (x, y) => [x, { ...y, fromZero: true }];
  const draw = (id, content) => charts[id].draw({ ...content, colours: { ink: INK, line: LINE, paper: PAPER } });
  const dot = (color, x, y, size = 4.5) => ({ x: [x], y: [y], color, marks: [true], size, width: 0, quiet: true });

  let chosen = [0, 0];
  let orbit = null;

  // The colours of numbers: Viridis in nine steps.
  const VIRIDIS = ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"];
  const channels = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
  const between = VIRIDIS.map(channels);
  function shade(part) {
    const at = Math.min(Math.max(part, 0), 1) * (between.length - 1), k = Math.min(Math.floor(at), between.length - 2);
    return between[k].map((value, c) => value + (at - k) * (between[k + 1][c] - value));
  }

  // One pixel per cell; where there is no value it stays clear.
  function picture(layer, values) {
    const [columns, rows] = layer.angles.map((own) => own.length), [low, high] = layer.range;
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [columns, rows];
    const pen = canvas.getContext("2d"), image = pen.createImageData(columns, rows);
    const colours = Object.fromEntries(layer.categories.map((code) => [code, channels(layer.colours[code])]));
    for (let i = 0; i < columns; i += 1) {
      for (let j = 0; j < rows; j += 1) {
        const value = values[i * rows + j];
        if (Number.isNaN(value)) continue;
        image.data.set([...(colours[value] || shade((value - low) / (high - low || 1))), 255], 4 * ((rows - 1 - j) * columns + i));
      }
    }
    pen.putImageData(image, 0, 0);
    return canvas.toDataURL();
  }

  function drawMap() {
    const layer = layers[element("layer").value];
    const values = valuesOf(layer);
    const ticks = ["0", "π/4", "π/2", "3π/4", "π"].map((text, k) => [k * Math.PI / 4, text]);
    draw("map", {
      // room for a mark at an end, also on a phone
      axes: ["α₁", "α₂"].map((title) => ({ title, unit: "rad", ticks, range: [-0.15, Math.PI + 0.15] })),
      equal: true,
      zoom: false,
      image: {
        href: picture(layer, values),
        ranges: layer.angles.map((own) => [own[0], own[own.length - 1]].map((end, k) => end + (k - 0.5) * (own[1] - own[0]))),
      },
      traces: [{ ...mark(), width: 0, marks: [false], size: 7.5, ring: 6, color: "#ffffff" }, { ...mark(), width: 0, marks: [false], size: 7.5, ring: 2.5, color: RED }],
      hover: (x, y) => {
        const cell = [x, y].map((value, axis) => nearest(layer.angles[axis], value));
        const told = cell.map((place, axis) => `α${"₁₂"[axis]} = ${fraction(layer.angles[axis][place], "π")}`).join(", ");
        return `${told}\n${written(layer, values[cell[0] * layer.angles[1].length + cell[1]])}`;
      },
      click: (x, y) => choose(pairAt([x, y])),
    });
    element("note").replaceChildren(...legend(layer));
  }

  function swatch(background, width) {
    const box = document.createElement("span");
    box.style.cssText = `display:inline-block;width:${width};height:0.9em;border:1px solid #555;vertical-align:-0.1em;background:${background}`;
    return box;
  }

  function legend(layer) {
    if (!layer.categories.length) {
      const [low, high] = layer.range.map((end) => written(layer, end));
      return [`${low} `, swatch(`linear-gradient(to right, ${VIRIDIS.join(", ")})`, "40%"), ` ${high}`, ...(layer.note ? [document.createElement("br"), layer.note] : [])];
    }
    return layer.categories.map((code) => {
      const entry = document.createElement("span");
      entry.style.cssText = "display:inline-block;margin-right:0.8em";
      entry.append(swatch(layer.colours[code], "0.9em"), ` ${layer.meanings[code]}`);
      return entry;
    });
  }

  function mark() {
    const [x, y] = [0, 1].map((axis) => [angles[axis][chosen[axis]]]);
    return { x, y };
  }

  function drawForce(cell) {
    const force = history("normalized_contact_force", cell);
    draw("force", {
      axes: axesOf({ title: "t", unit: "s" }, { title: "N / (k₃ lₚᵣₑ)" }),
      traces: [{ x: time, y: force, color: BLUE }, dot(RED, time[0], force[0])],
    });
  }

  function drawSpectrum(cell) {
    const natural = ["omega1_contact", "omega2_contact"].filter((key) => key in layers)
      .map((key) => layerValue(layers[key], chosen)).filter((value) => value > 0);
    draw("spectrum", {
      axes: axesOf({ title: "ω", unit: "rad/s" }, { title: "amplitude" }),
      traces: [{ x: frequency, y: history("force_spectrum", cell), color: BLUE }],
      rules: natural.map((value) => [0, value]),
    });
  }

  function drawBackbones(cell) {
    const traces = [], reasons = [], names = [];
    [BLUE, ORANGE].forEach((color, mode) => {
      const omega = branch("omega", cell, mode);
      const reason = payload.end.meanings[ends[2 * cell + mode]];
      if (omega.some(Number.isNaN)) { reasons.push(`mode ${mode + 1}: none (${reason})`); return; }
      reasons.push(`mode ${mode + 1} ends: ${reason}`);
      const marks = branch("stability_index", cell, mode).map((value) => Math.abs(value) <= 2);
      traces.push({ x: omega, y: branch("y_peak", cell, mode), name: `mode ${mode + 1}: y peak`, color, marks });
      traces.push({ x: omega, y: branch("x_amplitude", cell, mode), name: `mode ${mode + 1}: x amplitude`, color, dash: "6 4" });
    });
    draw("backbones", { axes: axesOf({ title: "ω", unit: "rad/s" }, { title: "displacement", unit: "m" }), traces, rules: [[1, preload]] });
    element("key").replaceChildren(...traces.map(({ name, color, marks }) => {
      const entry = document.createElement("span"), stroke = document.createElement("i");
      stroke.style.borderTop = `2px ${marks ? "solid" : "dashed"} ${color}`;
      entry.append(stroke, name);
      return entry;
    }));
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
    const { springs, contact, mass, colours } = mechanism(0);
    const drawn = (points, color) => ({ ...points, color, quiet: true });
    draw("orbit", {
      axes: [{ title: "x", unit: "m", range: xRange }, { title: "y", unit: "m", range: yRange }],
      equal: true,
      traces: [
        { x, y, color: "#9a9a9a", width: 1 },
        { x: ends.map((end) => end[0]), y: ends.map((end) => end[1]), color: INK, marks: [true, true], size: 4, width: 0, quiet: true },
        drawn(springs[0], colours[0]), drawn(springs[1], colours[1]), drawn(contact, colours[2]),
        dot(INK, ...mass, 6.5),
      ],
      rules: [[1, belt, INK, 3]],
    });
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
    element("clock").textContent = `t = ${+time[k].toPrecision(3)} s${orbit.force[k] > 0 ? "" : ", apart"}`;
  }

  function showInstant() {
    const k = Number(element("instant").value);
    const { springs, contact, mass, colours } = mechanism(k);
    [springs[0], springs[1], contact].forEach((points, place) => charts.orbit.move(2 + place, { ...points, color: colours[place] }));
    charts.orbit.move(5, { x: [mass[0]], y: [mass[1]] });
    charts.force.move(1, { x: [time[k]], y: [orbit.force[k]] });
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
    drawSpectrum(cell); if (ends) drawBackbones(cell);
    [0, 1].forEach((ring) => charts.map.move(ring, mark()));
  }

  const pairAt = (values) => values.map((value, axis) => nearest(angles[axis], value));

  // ---- animation --------------------------------------------------------------------------
  let playing = false, started = 0, shown = 0;
  const unitsPerSecond = time[time.length - 1] / 12;
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
    // The button names the pair that it opens: of the grid, the nearest one; the paper's only if near.
    const opened = pairAt(scene.angles);
    button.textContent = `${scene.name}: ${opened.map((place, axis) => fraction(angles[axis][place], "π")).join(", ")}`;
    button.addEventListener("click", () => choose(opened));
    const apart = opened.map((place, axis) => Math.abs(angles[axis][place] - scene.angles[axis]));
    if (Math.max(...apart) < (scene.near ?? Infinity)) element("scenes").append(button);
  }

  dark.addEventListener("change", () => { readColours(); drawMap(); choose(chosen); });

  const fromAddress = window.location.hash.slice(1).split(",").map((part) => Number(part) * Math.PI);
  const start = fromAddress.length === 2 && fromAddress.every(Number.isFinite) ? fromAddress
    : payload.scenes[0]?.near === null ? payload.scenes[0].angles : [5 * Math.PI / 6, 5 * Math.PI / 6];
  chosen = pairAt(start);
  drawMap();
  // The browser shows the map before the panels are drawn.
  setTimeout(() => {
    choose(chosen);
    document.body.dataset.ready = "true";
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) play(true);
  });
})();
