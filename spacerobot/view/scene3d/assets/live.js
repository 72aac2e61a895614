// Sliders, one for each joint: what they are set to is asked of the server, which answers with Pinocchio's poses.
(function () {
  "use strict";
  const player = window.SpacerobotPlayer;
  if (!player) return;
  const live = player.film.live, path = location.pathname + "/pose", rows = [];
  let version = -1, busy = false, moved = false, gone = 0;
  const element = function (kind, more, parent) {
    const found = Object.assign(document.createElement(kind), more);
    parent.append(found);
    return found;
  };
  const box = document.getElementById("joints");
  live.joints.forEach(function (joint) {
    // People read degrees and millimetres; the server takes SI.
    const scale = joint.turns ? 180 / Math.PI : 1000, unit = joint.turns ? "°" : "mm";
    const low = (joint.low * scale).toFixed(1), high = (joint.high * scale).toFixed(1);
    const line = element("label", { title: low + " to " + high + " " + unit }, box);
    element("span", { textContent: joint.name }, line);
    const range = element("input", { type: "range", min: joint.low, max: joint.high, step: "any" }, line);
    range.setAttribute("aria-label", joint.name);
    const field = element("input", { type: "number", min: low, max: high, step: "any" }, line);
    field.setAttribute("aria-label", joint.name + " in " + (joint.turns ? "degrees" : "millimetres"));
    element("span", { textContent: unit, className: "unit" }, line);
    const row = { value: 0, range: range };
    row.put = function (value, typing) {
      row.value = Math.min(joint.high, Math.max(joint.low, value));
      range.value = row.value;
      const words = (row.value * scale).toFixed(1);
      range.setAttribute("aria-valuetext", words + " " + unit);
      if (!typing) field.value = words;
    };
    range.addEventListener("input", function () { row.put(Number(range.value)); ask(); });
    field.addEventListener("input", function () {
      if (field.value !== "" && isFinite(field.value)) { row.put(Number(field.value) / scale, true); ask(); }
    });
    field.addEventListener("change", function () { row.put(row.value); });
    row.arm = joint.arm;
    rows.push(row);
  });
  element("button", { type: "button", textContent: "Back to the start" }, box).addEventListener("click", function () {
    rows.forEach(function (row, i) { row.put(live.start[i]); });
    ask();
  });
  const said = element("code", { title: "this pose for --q [rad or m]" }, box);
  function told() {
    const values = rows.filter(function (row) { return row.arm; }).map(function (row) { return Number(row.value.toFixed(4)); });
    said.textContent = values.length ? "--q " + values.join(" ") : "";
  }
  function put(still, sliders) {
    version = still.version;
    player.put(still);
    if (sliders) still.positions.forEach(function (value, i) { rows[i].put(value); });
    told();
  }
  function ask() {
    told();
    if (busy) { moved = true; return; }
    moved = false;
    send("?q=" + rows.map(function (row) { return row.value; }).join(","), false);
  }
  function send(query, sliders) {
    busy = true;
    fetch(path + query).then(function (answer) {
      gone = 0;
      if (answer.status === 204) return null;
      if (answer.ok) return answer.json();
      return answer.text().then(function (words) { throw new Error(words); });
    }).then(function (still) {
      trouble("");
      if (still) put(still, sliders && !moved);
    }).catch(function (error) {
      gone += 1;
      trouble(error instanceof TypeError ? "The view has ended: start it again and open its new address." : error.message);
    }).finally(function () {
      busy = false;
      if (moved) ask();
    });
  }
  function trouble(words) {
    document.getElementById("trouble").textContent = words;
    document.getElementById("trouble").hidden = !words;
  }
  put(live.still, true);
  // What Python sets, or another window, is seen here too.
  window.setInterval(function () {
    if (!busy && gone < 3 && !document.hidden) send("?since=" + version, true);
  }, 500);
})();
