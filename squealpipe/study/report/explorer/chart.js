"use strict";
// A chart in SVG: lines, marks and an image over two linear axes; hover, zoom by dragging, saving.
const chart = (() => {
  const MARGIN = { left: 58, right: 12, top: 8, bottom: 42 };
  const REACH = 40; // px from a point within which it is told
  const mouse = matchMedia("(pointer: fine)").matches;

  const shown = (value) => {
    const size = Math.abs(value);
    const text = size && (size >= 1e5 || size < 1e-3) ? (+value.toPrecision(4)).toExponential() : String(+value.toPrecision(4));
    return text.replaceAll("-", "−");
  };

  // About as many round numbers between two ends.
  function roundTicks([low, high], count, scale) {
    const rough = (high - low) / Math.max(count, 1), power = 10 ** Math.floor(Math.log10(rough));
    const step = power * ([1, 2, 2.5, 5].find((times) => times * power >= rough) || 10);
    const found = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1) found.push(k * step);
    return found.map((value) => [value, shown(value / scale)]);
  }

  // The power of ten that is told with the unit, so that no number on the axis is long.
  function powerOf(range) {
    const power = Math.floor(Math.log10(Math.max(...range.map(Math.abs))));
    return power > 4 || power < -2 ? power : 0;
  }
  const titleOf = ({ title, unit }, power) => {
    const raised = String(power).replace(/./g, (letter) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(letter)]);
    const words = [...(power ? [`10${raised}`] : []), ...(unit ? [unit] : [])].join(" ");
    return words ? `${title} (${words})` : title;
  };

  function rangeOf(values, axis) {
    if (axis.range) return axis.range;
    let low = axis.fromZero ? 0 : Infinity, high = axis.fromZero ? 0 : -Infinity;
    for (const value of values) if (Number.isFinite(value)) { low = Math.min(low, value); high = Math.max(high, value); }
    if (!(low <= high)) return [0, 1];
    const pad = 0.04 * (high - low) || 0.5 * Math.abs(high) || 1;
    return [axis.fromZero && low === 0 ? 0 : low - pad, high + pad];
  }

  // Ranges in which a unit has one length on both axes.
  function equalised(ranges, sizes) {
    const unit = Math.max(...ranges.map(([low, high], k) => (high - low) / sizes[k]));
    return ranges.map(([low, high], k) => {
      const middle = (low + high) / 2, half = unit * sizes[k] / 2;
      return [middle - half, middle + half];
    });
  }

  // One chart in `host`. `draw` takes { axes: two of { title, unit?, range?, fromZero?, ticks? }, equal?,
  // colours: { ink, line, paper }, traces, rules?: [axis, value, color?, thick?][], image?, hover?, click?, zoom? }.
  // A trace has x, y, color and, at will, width, dash, marks (filled or not, for each point), size,
  // ring, name, quiet (no hover).
  return (host) => {
    host.classList.add("chart");
    host.innerHTML = '<div class="drawing"></div><div class="tip" hidden></div><button class="save" type="button">Save SVG</button>';
    const [drawing, tip, save] = host.children;
    let spec, wanted, ranges, inner, sizes, from = null, band = null;

    const pixel = (axis, value) => {
      const part = (value - ranges[axis][0]) / (ranges[axis][1] - ranges[axis][0]);
      return sizes[axis] * (axis ? 1 - part : part);
    };
    const valueAt = (axis, at) => {
      const part = at / sizes[axis];
      return ranges[axis][0] + (axis ? 1 - part : part) * (ranges[axis][1] - ranges[axis][0]);
    };
    const points = (trace) => Array.from(trace.x, (x, k) => [pixel(0, x), pixel(1, trace.y[k])]);

    function shape(trace) {
      const { color, width = 1.4, dash = "", size = 3, marks, ring } = trace;
      const all = points(trace);
      let path = "", pen = "M";
      for (const [x, y] of all) {
        if (Number.isNaN(x + y)) pen = "M";
        else { path += `${pen}${x.toFixed(1)} ${y.toFixed(1)}`; pen = "L"; }
      }
      const circles = !marks ? "" : all.map(([x, y], k) => (Number.isNaN(x + y) ? "" : `<circle cx="${x.toFixed(1)}" cy="${y.toFixed(1)}" r="${size}" `
        + `fill="${marks[k] ? color : "none"}" stroke="${color}" stroke-width="${ring || 1}"/>`)).join("");
      return (width ? `<path d="${path}" fill="none" stroke="${color}" stroke-width="${width}" stroke-dasharray="${dash}"/>` : "") + circles;
    }

    function render() {
      const [width, height] = [host.clientWidth, host.clientHeight];
      sizes = [Math.max(width - MARGIN.left - MARGIN.right, 20), Math.max(height - MARGIN.top - MARGIN.bottom, 20)];
      wanted ??= spec.axes.map((axis, k) => rangeOf(spec.traces.flatMap((trace) => Array.from(k ? trace.y : trace.x)), axis));
      ranges = spec.equal ? equalised(wanted, sizes) : wanted;
      const { ink, line, paper } = spec.colours, [w, h] = sizes;
      const powers = spec.axes.map((axis, k) => (axis.ticks ? 0 : powerOf(ranges[k])));
      const grid = spec.axes.map((axis, k) => (axis.ticks || roundTicks(ranges[k], sizes[k] / (k ? 45 : 70), 10 ** powers[k])).map(([value, text]) => {
        const at = pixel(k, value).toFixed(1);
        return k
          ? `<path d="M0 ${at}H${w}" stroke="${line}"/><text class="ytick" x="-6" y="${at}" dy="0.35em" text-anchor="end">${text}</text>`
          : `<path d="M${at} 0V${h}" stroke="${line}"/><text class="xtick" x="${at}" y="${h + 16}" text-anchor="middle">${text}</text>`;
      }).join("")).join("");
      const rules = (spec.rules || []).map(([axis, value, color = "#7F7F7F", thick = 1.5]) => {
        const at = pixel(axis, value).toFixed(1);
        return `<path d="${axis ? `M0 ${at}H${w}` : `M${at} 0V${h}`}" stroke="${color}" stroke-width="${thick}" ${axis ? "" : 'stroke-dasharray="2 3"'}/>`;
      }).join("");
      let picture = "";
      if (spec.image) {
        const [[x0, x1], [y0, y1]] = spec.image.ranges.map((ends, axis) => ends.map((end) => pixel(axis, end)));
        picture = `<image href="${spec.image.href}" x="${x0}" y="${y1}" width="${x1 - x0}" height="${y0 - y1}" preserveAspectRatio="none" style="image-rendering:pixelated"/>`;
      }
      drawing.innerHTML = `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" style="background:${paper}" font-family="system-ui, sans-serif" font-size="12" fill="${ink}">
        <g transform="translate(${MARGIN.left} ${MARGIN.top})">${grid}
        <text x="${w / 2}" y="${h + 36}" text-anchor="middle">${titleOf(spec.axes[0], powers[0])}</text>
        <text transform="translate(-47 ${h / 2}) rotate(-90)" text-anchor="middle">${titleOf(spec.axes[1], powers[1])}</text>
        <svg width="${w}" height="${h}" overflow="hidden">${picture}${rules}${spec.traces.map((trace) => `<g>${shape(trace)}</g>`).join("")}<rect fill="${ink}" fill-opacity="0.15"/></svg></g></svg>`;
      inner = drawing.querySelector("svg svg");
      band = inner.lastChild;
    }

    function nearest(x, y) {
      let best = null, least = REACH;
      for (const trace of spec.traces) {
        if (trace.quiet) continue;
        points(trace).forEach(([px, py], k) => {
          const distance = Math.hypot(px - x, py - y);
          if (distance < least) { least = distance; best = [trace, k]; }
        });
      }
      if (!best) return "";
      const [trace, k] = best, told = [trace.x[k], trace.y[k]];
      return [...(trace.name ? [trace.name] : []), ...spec.axes.map((axis, own) => `${axis.title} = ${shown(told[own])} ${axis.unit || ""}`.trim())].join("\n");
    }

    function place(event) {
      const box = drawing.getBoundingClientRect();
      return [event.clientX - box.x - MARGIN.left, event.clientY - box.y - MARGIN.top];
    }
    const inside = ([x, y]) => x >= 0 && y >= 0 && x <= sizes[0] && y <= sizes[1];

    const clearBand = () => { band.setAttribute("width", 0); };
    drawing.addEventListener("pointermove", (event) => {
      const at = place(event);
      const text = from || !inside(at) ? "" : (spec.hover ? spec.hover(valueAt(0, at[0]), valueAt(1, at[1])) : nearest(...at));
      tip.hidden = !text;
      tip.textContent = text;
      const beside = at[0] > sizes[0] / 2 ? at[0] + MARGIN.left - tip.offsetWidth - 12 : at[0] + MARGIN.left + 12;
      tip.style.translate = `${beside}px ${Math.max(at[1] - 30, 0)}px`;
      if (!from) return;
      [["x", "width"], ["y", "height"]].forEach(([start, size], k) => {
        band.setAttribute(start, Math.min(from[k], at[k]));
        band.setAttribute(size, Math.abs(from[k] - at[k]));
      });
    });
    drawing.addEventListener("pointerleave", () => { tip.hidden = true; });
    drawing.addEventListener("pointerdown", (event) => {
      const at = place(event);
      if (spec.zoom === false || event.pointerType !== "mouse" || event.button || !inside(at)) return;
      event.preventDefault();
      from = at;
      drawing.setPointerCapture(event.pointerId);
    });
    drawing.addEventListener("pointerup", (event) => {
      if (!from) return;
      const start = from, to = place(event).map((at, k) => Math.min(Math.max(at, 0), sizes[k]));
      from = null;
      if (start.every((at, k) => Math.abs(at - to[k]) > 5)) {
        wanted = start.map((at, k) => [valueAt(k, at), valueAt(k, to[k])].sort((a, b) => a - b));
        render();
      } else clearBand();
    });
    drawing.addEventListener("pointercancel", () => { from = null; clearBand(); });
    drawing.addEventListener("dblclick", () => { wanted = null; render(); });
    drawing.addEventListener("click", (event) => {
      const at = place(event);
      if (spec.click && inside(at)) spec.click(valueAt(0, at[0]), valueAt(1, at[1]));
    });
    save.hidden = !mouse;
    save.addEventListener("click", () => {
      const link = document.createElement("a");
      link.href = URL.createObjectURL(new Blob([drawing.innerHTML], { type: "image/svg+xml" }));
      link.download = `${host.id}.svg`;
      link.click();
      URL.revokeObjectURL(link.href);
    });
    new ResizeObserver(() => {
      const drawn = drawing.firstElementChild;
      if (drawn && (+drawn.getAttribute("width") !== host.clientWidth || +drawn.getAttribute("height") !== host.clientHeight)) render();
    }).observe(host);

    const own = {
      draw(content) { spec = content; wanted = null; from = null; render(); own.traces = spec.traces; },
      // Another place or colour for one trace.
      move(k, change) { Object.assign(spec.traces[k], change); inner.querySelectorAll(":scope > g")[k].innerHTML = shape(spec.traces[k]); },
      pixel(x, y) {
        const box = drawing.getBoundingClientRect();
        return [box.x + MARGIN.left + pixel(0, x), box.y + MARGIN.top + pixel(1, y)];
      },
    };
    host.chart = own; // for tests and the curious
    return own;
  };
})();
