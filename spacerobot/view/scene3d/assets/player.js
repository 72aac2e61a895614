// The player: moves the bodies along the time line, draws arrow, trails and track, and answers buttons and keys.
(function () {
  "use strict";
  const $ = function (id) { return document.getElementById(id); };
  const film = JSON.parse($("film").textContent);
  const bytes = function (text) {
    const raw = atob(text), out = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; i += 1) out[i] = raw.charCodeAt(i);
    return out;
  };
  const numbers = new Float32Array(bytes(film.numbers).buffer);
  const take = function (place) { return numbers.subarray(place[0], place[0] + place[1]); };
  const T = MeshCat.THREE, time = take(film.time), last = time.length - 1;
  let viewer;
  try {
    viewer = new MeshCat.Viewer($("pane"));
  } catch (error) {
    $("trouble").hidden = false;
    return;
  }
  const asked = new URLSearchParams(location.hash.slice(1));
  SpacerobotStage.build(viewer, film, asked.get("light") === "full");
  JSON.parse($("messages").textContent).forEach(function (m) { viewer.handle_command_bytearray(bytes(m)); });
  SpacerobotStage.dull(viewer);
  const world = new T.Group();
  viewer.scene.add(world);

  // What moves.
  const bodies = film.bodies.map(function (b) {
    const body = { object: viewer.scene_tree.find(b.path).object, poses: take(b.poses), moving: b.moving, kind: b.kind };
    if (b.mismatch) body.mismatch = take(b.mismatch);
    if (b.beside) body.beside = take(b.beside);
    if (b.stretch) body.stretch = take(b.stretch);
    if (b.kind === "ghost") {
      body.materials = [];
      body.object.traverse(function (o) { if (o.material) body.materials.push(o.material); });
    }
    return body;
  });
  const trails = film.trails.map(function (t) {
    const geometry = new T.BufferGeometry();
    geometry.setAttribute("position", new T.BufferAttribute(take(t.points), 3));
    const colour = new T.Color(t.colour[0], t.colour[1], t.colour[2]).convertSRGBToLinear();
    const line = new T.Line(geometry, new T.LineBasicMaterial({ color: colour, toneMapped: false }));
    line.frustumCulled = false;
    world.add(line);
    return { name: t.name, line: line };
  });
  const marker = function (radius, colour, glow) {
    const mesh = new T.Mesh(new T.SphereGeometry(radius, 24, 16), new T.MeshStandardMaterial({
      color: colour, roughness: 0.35, metalness: 0.1, emissive: colour, emissiveIntensity: glow,
    }));
    world.add(mesh);
    return mesh;
  };
  function quartered(radius) {
    // The sign for a centre of mass: a ball whose eighths are black and yellow by turns.
    const ball = new T.SphereGeometry(radius, 32, 16).toNonIndexed(), p = ball.attributes.position, colours = [];
    for (let i = 0; i < p.count; i += 3) {
      const sum = function (get) { return p[get](i) + p[get](i + 1) + p[get](i + 2); };
      const dark = sum("getX") * sum("getY") * sum("getZ") > 0;
      for (let k = 0; k < 3; k += 1) colours.push(...(dark ? [0.01, 0.01, 0.015] : [0.93, 0.58, 0.05]));
    }
    ball.setAttribute("color", new T.Float32BufferAttribute(colours, 3));
    const mesh = new T.Mesh(ball, new T.MeshBasicMaterial({ vertexColors: true, depthTest: false, transparent: true, toneMapped: false }));
    mesh.renderOrder = 6;
    return mesh;
  }
  let arrow = null, touch = null, centre = null, ellipsoid = null;
  if (film.arrow) {
    // Seen through everything: it acts inside the contact.
    const paint = new T.MeshBasicMaterial({ color: 0xe0230f, depthTest: false, transparent: true, toneMapped: false });
    const r = 0.007, shaft = new T.Mesh(new T.CylinderGeometry(r, r, 1, 24), paint);
    shaft.geometry.rotateX(Math.PI / 2).translate(0, 0, 0.5);
    const head = new T.Mesh(new T.ConeGeometry(2.4 * r, 5.5 * r, 28), paint);
    head.geometry.rotateX(Math.PI / 2).translate(0, 0, 2.75 * r);
    const group = new T.Group();
    shaft.renderOrder = head.renderOrder = 7;
    group.add(shaft, head);
    world.add(group);
    arrow = { group: group, shaft: shaft, head: head, tip: 5.5 * r, force: take(film.arrow.force), point: take(film.arrow.point),
      direction: take(film.arrow.direction), scale: film.arrow.scale };
    touch = marker(1.2 * r, 0xffd23f, 0.9);
    touch.material.depthTest = false;
    touch.material.transparent = true;
    touch.renderOrder = 8;
  }
  if (film.centreOfMass) {
    centre = { track: take(film.centreOfMass), mesh: quartered(Math.min(0.024 * film.reach, 0.032)) };
    world.add(centre.mesh);
    const path = new T.BufferGeometry();
    path.setAttribute("position", new T.BufferAttribute(centre.track, 3));
    centre.line = new T.Line(path, new T.LineBasicMaterial({ color: 0xf7c948 }));
    centre.line.frustumCulled = false;
    world.add(centre.line);
  }
  if (film.ellipsoid) {
    ellipsoid = new SpacerobotMass.Ellipsoid(world, film.ellipsoid.scale, film.ellipsoid.limit, film.place === "space");
    ellipsoid.centre = take(film.ellipsoid.centre);
    ellipsoid.mobility = take(film.ellipsoid.mobility);
  }

  // Between two samples.
  let i0 = 0, share = 0, gain = film.gains[0];
  function locate(t) {
    let low = 0, high = last;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (time[middle] <= t) low = middle; else high = middle;
    }
    i0 = low;
    share = last === 0 ? 0 : Math.min(1, Math.max(0, (t - time[low]) / (time[low + 1] - time[low])));
  }
  function mix(array, width, out) {
    const a = i0 * width, b = Math.min(i0 + 1, last) * width;
    for (let k = 0; k < width; k += 1) out[k] = array[a + k] * (1 - share) + array[b + k] * share;
    return out;
  }
  const v3 = [0, 0, 0], v9 = new Array(9).fill(0), v1 = [0];
  const qa = new T.Quaternion(), qb = new T.Quaternion();
  function heat(sigmas) {
    // Green within the noise, amber at about five sigmas, vermilion from ten on.
    const x = Math.min(1, Math.max(0, (sigmas - 1) / 9));
    const stops = [[0, 0.62, 0.45], [0.9, 0.76, 0.16], [0.84, 0.37, 0]], k = x < 0.5 ? 0 : 1, f = (x - 0.5 * k) * 2;
    return new T.Color().setRGB(...stops[k].map(function (v, c) { return v * (1 - f) + stops[k + 1][c] * f; })).convertSRGBToLinear();
  }
  function pose(body) {
    const p = body.poses, o = body.object;
    if (!body.moving) {
      o.position.set(p[0], p[1], p[2]);
      o.quaternion.set(p[3], p[4], p[5], p[6]);
      return;
    }
    const a = 7 * i0, b = 7 * Math.min(i0 + 1, last);
    o.position.set(p[a] + share * (p[b] - p[a]), p[a + 1] + share * (p[b + 1] - p[a + 1]), p[a + 2] + share * (p[b + 2] - p[a + 2]));
    qa.set(p[a + 3], p[a + 4], p[a + 5], p[a + 6]);
    qb.set(p[b + 3], p[b + 4], p[b + 5], p[b + 6]);
    o.quaternion.copy(qa.slerp(qb, share));
    if (body.beside && gain !== 1) apart(body, a, b);
  }
  function apart(body, a, b) {
    // A ghost drawn further from the simulation than it is, so that the difference can be seen.
    const s = body.beside, o = body.object;
    const from = [0, 1, 2].map(function (k) { return s[a + k] + share * (s[b + k] - s[a + k]); });
    o.position.set(from[0] + gain * (o.position.x - from[0]), from[1] + gain * (o.position.y - from[1]), from[2] + gain * (o.position.z - from[2]));
    qa.set(s[a + 3], s[a + 4], s[a + 5], s[a + 6]);
    qb.set(s[b + 3], s[b + 4], s[b + 5], s[b + 6]);
    qa.slerp(qb, share);
    const turn = o.quaternion.clone().multiply(qa.clone().invert());
    if (turn.w < 0) turn.set(-turn.x, -turn.y, -turn.z, -turn.w);
    const sine = Math.hypot(turn.x, turn.y, turn.z), angle = 2 * Math.atan2(sine, turn.w);
    if (sine > 1e-9) {
      turn.setFromAxisAngle(new T.Vector3(turn.x / sine, turn.y / sine, turn.z / sine), Math.min(gain * angle, Math.PI));
      o.quaternion.copy(turn.multiply(qa));
    }
  }
  function show(t) {
    locate(t);
    bodies.forEach(function (body) {
      pose(body);
      if (body.stretch) body.object.scale.z = mix(body.stretch, 1, v1)[0];
      if (body.mismatch) {
        const colour = heat(mix(body.mismatch, 1, v1)[0]);
        body.materials.forEach(function (m) { m.color.copy(colour); });
      }
    });
    const drawn = i0 + 1 + (share > 0.5 ? 1 : 0);
    trails.forEach(function (trail) { trail.line.geometry.setDrawRange(0, drawn); });
    if (arrow) {
      const force = mix(arrow.force, 1, v1)[0], on = Math.abs(force) > 1e-9 && arrow.wanted !== false;
      const p = mix(arrow.point, 3, v3).slice(), d = mix(arrow.direction, 3, [0, 0, 0]);
      const sign = force < 0 ? -1 : 1, length = Math.abs(force) * arrow.scale, head = Math.min(arrow.tip, 0.6 * length);
      arrow.group.visible = touch.visible = on;
      if (on) {
        arrow.group.position.set(p[0], p[1], p[2]);
        arrow.group.quaternion.setFromUnitVectors(new T.Vector3(0, 0, 1), new T.Vector3(sign * d[0], sign * d[1], sign * d[2]).normalize());
        arrow.shaft.scale.z = Math.max(length - head, 1e-6);
        arrow.head.scale.setScalar(head / arrow.tip);
        arrow.head.position.z = length - head;
        touch.position.set(p[0], p[1], p[2]);
      }
    }
    if (centre) {
      const p = mix(centre.track, 3, v3);
      centre.mesh.position.set(p[0], p[1], p[2]);
      centre.line.geometry.setDrawRange(0, drawn);
    }
    if (ellipsoid) ellipsoid.set(mix(ellipsoid.centre, 3, v3), mix(ellipsoid.mobility, 9, v9));
    film.readouts.forEach(function (r) {
      const unit = r.unit ? " " + r.unit : "";
      r.cell.textContent = text(r.now === undefined ? mix(take(r.values), 1, v1)[0] : r.now, r.digits) + (r.recorded ? "" : unit);
      if (r.recorded) r.second.textContent = text(mix(take(r.recorded), 1, v1)[0], r.digits) + unit;
    });
    $("clock").textContent = (film.start + t).toFixed(film.length < 5 ? 3 : 2) + " s";
    $("time").value = t;
    $("time").setAttribute("aria-valuetext", $("clock").textContent);
    viewer.set_dirty();
  }
  function text(v, digits) {
    if (!isFinite(v) || Math.abs(v) > 1e30) return "∞";
    return (Math.abs(v) < 0.5 * Math.pow(10, -digits) ? 0 : v).toFixed(digits).replace("-", "−");
  }

  // What is said and what can be pressed.
  const pairs = film.readouts.some(function (r) { return r.recorded; });
  const cell = function (kind, words) {
    const element = document.createElement(kind);
    element.textContent = words;
    $("readouts").append(element);
    return element;
  };
  if (pairs) {
    $("readouts").className = "pairs";
    cell("dt", "");
    cell("dd", "simulated").className = "head";
    cell("dd", "recorded").className = "head";
  }
  film.readouts.forEach(function (r) {
    cell("dt", r.name);
    r.cell = cell("dd", "");
    if (pairs) r.second = cell("dd", "");
  });
  function toggle(label, objects, then) {
    const box = document.createElement("input"), line = document.createElement("label");
    box.type = "checkbox";
    box.checked = true;
    line.append(box, " " + label);
    box.addEventListener("change", function () {
      objects.forEach(function (o) { o.visible = box.checked; });
      if (then) then(box.checked);
      show(now);
    });
    $("switches").append(line);
  }
  const ghosts = bodies.filter(function (b) { return b.kind === "ghost"; });
  if (ghosts.length) toggle(film.ghost[0], ghosts.map(function (b) { return b.object; }));
  if (ghosts.length && film.gains.length > 1) {
    const line = document.createElement("label"), pick = document.createElement("select");
    film.gains.forEach(function (g) {
      const o = document.createElement("option");
      o.value = g;
      o.textContent = g === 1 ? "true to scale" : g + " times enlarged";
      pick.append(o);
    });
    pick.addEventListener("change", function () { gain = Number(pick.value); show(now); });
    line.append("difference ", pick);
    $("switches").append(line);
  }
  if (arrow) toggle("force", [], function (on) { arrow.wanted = on; });
  if (ellipsoid) toggle("effective mass", [ellipsoid.group]);
  if (centre) toggle("centre of mass", [centre.mesh, centre.line]);
  if (trails.length) toggle("trails", trails.map(function (t) { return t.line; }));
  const said = [];
  const round = function (v) { return Number(v.toPrecision(2)); };
  if (arrow) said.push("Force arrow: 10 cm is " + round(0.1 / arrow.scale) + " N.");
  if (ellipsoid) said.push("Violet: effective mass felt in each direction, 10 cm is " + round(0.1 / ellipsoid.scale) + " kg.");
  if (centre) said.push("Black and yellow: centre of mass" + (film.centreLabel ? " " + film.centreLabel : "") + ".");
  $("legend").textContent = said.join(" ");
  if (ghosts.length) {
    const swatch = document.createElement("span"), line = document.createElement("span");
    swatch.className = "swatch";
    line.append(" Translucent: " + film.ghost[1] + " ", swatch, " or are 10 σ apart.");
    $("legend").append(line);
  }
  film.views.forEach(function (view, i) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = view.name;
    button.title = "key " + (i + 1);
    button.addEventListener("click", function () { see(view.name); });
    $("views").append(button);
  });
  function see(name) {
    const view = film.views.find(function (v) { return v.name.toLowerCase() === name.toLowerCase(); }) || film.views[0];
    SpacerobotStage.look(viewer, view.focus, view.reach, view.direction);
  }

  window.addEventListener("resize", function () { SpacerobotStage.clear(viewer); viewer.set_dirty(); });

  // The time line.
  const chart = film.readouts.find(function (r) { return r.name === film.chart; });
  if (chart) {
    const values = take(chart.recorded || chart.values), top = Math.max.apply(null, Array.from(values, Math.abs).filter(isFinite)) || 1;
    const place = $("chart"), none = { show: false };
    const size = function () { return { width: Math.max(place.clientWidth, 1), height: place.clientHeight }; };
    const heights = Array.from(values, function (v) { return isFinite(v) ? Math.abs(v) : null; });
    const plot = new uPlot({
      ...size(), padding: [0, 0, 0, 0], legend: none, cursor: none, axes: [none, none],
      scales: { x: { time: false, range: [0, film.length] }, y: { range: [0, top] } },
      series: [{}, { width: 0, fill: getComputedStyle(place).color, points: none }],
    }, [Array.from(time), heights], place);
    new ResizeObserver(function () { plot.setSize(size()); }).observe(place);
  }
  let free = 0;
  film.marks.forEach(function (m) {
    const line = document.createElement("span"), share = m.time / film.length;
    const wide = (6.4 * m.label.length + 14) / Math.max($("marks").clientWidth, 200);
    const left = share + wide > 1, start = left ? share - wide : share;
    line.style.left = 100 * share + "%";
    line.title = m.label;
    line.className = (left ? "left " : "") + (m.quiet ? "quiet" : "");
    if (!m.quiet && start >= free) {
      // Where there is no room for its words, a mark is a line alone.
      const label = document.createElement("b");
      label.textContent = m.label;
      line.append(label);
      free = left ? share : share + wide;
    }
    $("marks").append(line);
  });
  const SPEEDS = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10];
  const natural = SPEEDS.reduce(function (best, s) {
    return Math.abs(Math.log(film.length / s / 9)) < Math.abs(Math.log(film.length / best / 9)) ? s : best;
  }, 1);
  SPEEDS.forEach(function (s) {
    const o = document.createElement("option");
    o.value = s;
    o.textContent = s + "×";
    o.selected = s === natural;
    $("speed").append(o);
  });
  $("time").max = film.length;
  let now = 0, playing = false, before = null;
  function play(on) {
    if (on && now >= film.length) now = 0;
    playing = on && film.length > 0;
    before = null;
    $("play").textContent = playing ? "❚❚" : "▶";
    $("play").setAttribute("aria-label", playing ? "Pause" : "Play");
  }
  function seek(t) {
    now = Math.min(film.length, Math.max(0, t));
    show(now);
  }
  function tick(stamp) {
    requestAnimationFrame(tick);
    if (!playing) return;
    if (before !== null) {
      now += Math.min(stamp - before, 100) / 1000 * Number($("speed").value);
      if (now >= film.length) {
        if ($("loop").checked) now -= film.length; else { now = film.length; play(false); }
      }
      show(Math.min(now, film.length));
    }
    before = stamp;
  }
  $("play").addEventListener("click", function () { play(!playing); });
  $("time").addEventListener("input", function () { play(false); seek(Number(this.value)); });
  document.addEventListener("keydown", function (event) {
    if (event.ctrlKey || event.metaKey || event.altKey || /^(SELECT|TEXTAREA)$/.test(event.target.tagName) || event.target.type === "number") return;
    const step = film.length / (event.shiftKey ? 20 : 200);
    if (event.key === " " && !/^(BUTTON|INPUT)$/.test(event.target.tagName)) play(!playing);
    else if (event.key === "ArrowRight" && event.target.type !== "range") { play(false); seek(now + step); }
    else if (event.key === "ArrowLeft" && event.target.type !== "range") { play(false); seek(now - step); }
    else if (/^[1-9]$/.test(event.key) && film.views[event.key - 1]) see(film.views[event.key - 1].name);
    else return;
    event.preventDefault();
  });

  // #t=0.5&view=contact in the address opens the page there, still.
  see(asked.get("view") || "");
  seek(asked.has("t") ? Number(asked.get("t")) || 0 : 0);
  $("bar").hidden = film.length === 0;
  if (!asked.has("t") && !window.matchMedia("(prefers-reduced-motion: reduce)").matches) play(true);
  window.addEventListener("load", function () { see(asked.get("view") || ""); });
  requestAnimationFrame(tick);

  // A film of one moment may be put into another pose.
  window.SpacerobotPlayer = {
    film: film,
    put: function (still) {
      bodies.forEach(function (body, i) {
        body.poses = still.poses[i];
        if (body.stretch) body.stretch = [still.stretch[i]];
      });
      if (centre) centre.track = still.centreOfMass;
      if (ellipsoid) {
        ellipsoid.centre = still.centre;
        ellipsoid.mobility = still.mobility.flat();
      }
      film.readouts.forEach(function (r, i) { r.now = still.readouts[i]; });
      show(now);
    },
  };
})();
