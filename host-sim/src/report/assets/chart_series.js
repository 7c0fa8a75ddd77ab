// The series of a chart as uPlot wants them.
const chartSeries = (() => {
  const faint = (colour) => colour + "38";

  // uPlot wants one column of x. What a series does not have there is undefined, and drawn through.
  function columns(spec) {
    const tables = spec.axes.map((axis) => [axis]);
    const at = spec.series.map((series) => {
      const table = tables[series.axis];
      const first = table.push(series.y) - 1;
      if (series.mark === "band") table.push(series.lower);
      return first;
    });
    const before = [];
    tables.reduce((sum, table, i) => ((before[i] = sum), sum + table.length - 1), 0);
    return {
      data: tables.length === 1 ? tables[0] : uPlot.join(tables),
      at: spec.series.map((series, i) => before[series.axis] + at[i]),
    };
  }

  // The index nearest to the pointer at which the series has a point.
  function nearest(u, series, index, x) {
    const [xs, ys] = [u.data[0], u.data[series]];
    if (ys[index] !== undefined) return index;
    let [low, high] = [index, index];
    while (low > 0 && ys[low] === undefined) low--;
    while (high < ys.length - 1 && ys[high] === undefined) high++;
    if (ys[low] === undefined) return high;
    if (ys[high] === undefined) return low;
    return x - xs[low] <= xs[high] - x ? low : high;
  }

  function seriesOptions(spec, index) {
    const series = spec.series[index];
    const colour = ofPair(series.colour);
    const common = {
      label: series.name || spec.y,
      width: 1.75,
      value: (u, value) => short(value),
      points: { show: false },
    };
    switch (series.mark) {
      case "dashed":
        return { ...common, stroke: colour, dash: [7, 5] };
      case "dots":
        return { ...common, stroke: colour, paths: () => null, points: { show: true, size: 5, fill: colour, width: 0 } };
      case "bars":
        return { ...common, stroke: colour, fill: faint(colour), width: 1, paths: uPlot.paths.bars({ size: [1, Infinity] }) };
      case "band":
        return { ...common, stroke: "transparent", fill: faint(colour), isBand: true };
      default:
        return { ...common, stroke: colour };
    }
  }

  // All series of uPlot, where they are in its data, and its bands.
  function allSeries(spec, at) {
    const options = [{ label: spec.x, value: (u, value) => short(value) }];
    const bands = [];
    spec.series.forEach((series, i) => {
      const isNamed = series.name || spec.series.length === 1;
      options[at[i]] = { ...seriesOptions(spec, i), class: isNamed ? `is-${series.mark}` : "hidden" };
      if (series.mark !== "band") return;
      const edge = { label: "", class: "hidden", stroke: "transparent", points: { show: false } };
      options[at[i] + 1] = edge;
      options[at[i]].value = (u, upper, si, index) =>
        upper === null || upper === undefined || index === null
          ? "–"
          : `${short(u.data[si + 1][index])} to ${short(upper)}`;
      bands.push({ series: [at[i], at[i] + 1], fill: faint(ofPair(series.colour)) });
    });
    return { series: options, bands };
  }

  // Keys of the legend look as what they name: a line, a dashed line, an area.
  function markers(spec, at) {
    const of = (i) => spec.series[at.indexOf(i)];
    const colour = (i) => (of(i) ? ofPair(of(i).colour) : "transparent");
    const isArea = (i) => of(i) && (of(i).mark === "band" || of(i).mark === "bars");
    return {
      width: 0,
      stroke: () => "transparent",
      fill: (u, i) =>
        isArea(i) ? faint(colour(i))
        : of(i) && of(i).mark === "dashed"
          ? `repeating-linear-gradient(to right, ${colour(i)} 0 .45em, transparent .45em .7em)`
          : colour(i),
    };
  }

  return { columns, nearest, allSeries, markers };
})();
