// What a chart shows besides its series: shaded ranges, ticks, and where a curve leaves the axis.
const chartMarks = (() => {
  // Grey where the data say so; drawn below the curves.
  function drawShaded(u, spec) {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.fillStyle = "#99999940";
    for (const [from, to] of spec.shaded) {
      const left = u.valToPos(from, "x", true);
      ctx.fillRect(left, bbox.top, Math.max(u.valToPos(to, "x", true) - left, 1), bbox.height);
    }
    ctx.restore();
  }

  function drawTicks(u, spec) {
    const { ctx, bbox } = u;
    ctx.fillStyle = themed("--ink");
    for (const tick of spec.ticks) {
      const x = u.valToPos(tick, "x", true);
      if (x < bbox.left || x > bbox.left + bbox.width) continue;
      const height = 0.08 * bbox.height;
      ctx.fillRect(x, bbox.top + bbox.height - height, devicePixelRatio, height);
    }
  }

  // A triangle at the edge where a curve leaves the axis: one for each stay beyond it.
  function drawBeyond(u, spec, at) {
    const { min, max } = u.scales.y;
    const size = 6 * devicePixelRatio;
    spec.series.forEach((series, i) => {
      if (series.mark === "band" || !u.series[at[i]].show) return;
      u.ctx.fillStyle = ofPair(series.colour);
      const [xs, ys] = [u.data[0], u.data[at[i]]];
      let was = 0;
      for (let k = u.series[0].idxs[0]; k <= u.series[0].idxs[1]; k++) {
        if (ys[k] === undefined) continue;
        const is = ys[k] === null ? 0 : ys[k] > max ? 1 : ys[k] < min ? -1 : 0;
        if (is && is !== was) triangle(u, u.valToPos(xs[k], "x", true), is, size);
        was = is;
      }
    });
  }

  function triangle(u, x, up, size) {
    const edge = up > 0 ? u.bbox.top : u.bbox.top + u.bbox.height;
    u.ctx.beginPath();
    u.ctx.moveTo(x, edge);
    u.ctx.lineTo(x - size / 1.6, edge + up * size);
    u.ctx.lineTo(x + size / 1.6, edge + up * size);
    u.ctx.fill();
  }

  return { drawShaded, drawTicks, drawBeyond };
})();
