// What figures along the same way share: the place under the pointer, and the zoomed range.
const links = (() => {
  const members = new Map();
  return {
    // A member has `hover(x)` (null: nowhere) and `range(limits)` (null: everything).
    join(link, member) {
      if (!link) return;
      if (!members.has(link)) members.set(link, []);
      members.get(link).push(member);
    },
    leaveAll() {
      members.clear();
    },
    tell(link, from, what, value) {
      for (const member of members.get(link) || []) {
        if (member !== from && member[what]) member[what](value);
      }
    },
  };
})();

// A colour of the page's theme by its name in the style sheet.
const themed = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const isDark = matchMedia("(prefers-color-scheme: dark)");
// Colours come as a pair: on a light page, on a dark page.
const ofPair = (pair) => pair[isDark.matches ? 1 : 0];

const element = (tag, parent, properties) =>
  parent.appendChild(Object.assign(document.createElement(tag), properties));

// A number in about five digits, without trailing zeros.
const short = (value) =>
  value === null || value === undefined || !isFinite(value)
    ? "–"
    : String(Number(value.toPrecision(5))).replace("-", "−");
