// The stage: light, ground or sky, camera. Uses the three.js that meshcat's viewer carries.
window.SpacerobotStage = (function () {
  "use strict";
  const T = MeshCat.THREE;

  function room(space) {
    // A bare room with lamps, from which metal takes its reflections.
    const scene = new T.Scene();
    const walls = new T.Mesh(new T.BoxGeometry(10, 10, 10),
      new T.MeshBasicMaterial({ side: T.BackSide, color: space ? 0x060a12 : 0x33373d }));
    scene.add(walls);
    const lamp = function (x, y, z, w, h, d, power, tint) {
      const colour = new T.Color(tint || 0xffffff).multiplyScalar(power);
      const mesh = new T.Mesh(new T.BoxGeometry(w, h, d), new T.MeshBasicMaterial({ color: colour }));
      mesh.position.set(x, y, z);
      scene.add(mesh);
    };
    lamp(0, 0, 4.6, 4, 4, 0.1, space ? 4.2 : 5);
    lamp(4.4, -2.5, 2, 0.1, 3, 3, space ? 6 : 4);
    lamp(-4.4, 2, 1, 0.1, 2, 4, space ? 1.2 : 1.6);
    lamp(0, -4.6, 0.5, 5, 0.1, 2.4, space ? 2 : 1.6);
    lamp(0, 0, -4.7, 8, 8, 0.1, space ? 1.2 : 0.25, space ? 0x2b62b8 : 0xffffff);
    return scene;
  }
  function stars(scene) {
    let seed = 7;
    const random = function () { seed = (seed * 16807) % 2147483647; return seed / 2147483647; };
    [[900, 1.3, 0.45], [260, 2.0, 0.9]].forEach(function (kind) {
      const points = [];
      for (let i = 0; i < kind[0]; i += 1) {
        const z = 2 * random() - 1, a = 2 * Math.PI * random(), r = Math.sqrt(1 - z * z);
        points.push(90 * r * Math.cos(a), 90 * r * Math.sin(a), 90 * z);
      }
      const geometry = new T.BufferGeometry();
      geometry.setAttribute("position", new T.Float32BufferAttribute(points, 3));
      scene.add(new T.Points(geometry, new T.PointsMaterial({
        color: 0xdfe8ff, size: kind[1], sizeAttenuation: false, transparent: true, opacity: kind[2],
      })));
    });
  }
  function ground(scene, film) {
    const size = 14 * film.reach;
    const shade = new T.Mesh(new T.CircleGeometry(size, 72),
      new T.MeshStandardMaterial({ color: 0xa3aab1, roughness: 0.95, metalness: 0, transparent: true }));
    shade.material.onBeforeCompile = function (shader) {
      // The floor fades into the background, so that it has no edge.
      shader.vertexShader = "varying vec2 vOnFloor;\n" + shader.vertexShader.replace("#include <begin_vertex>",
        "#include <begin_vertex>\nvOnFloor = position.xy;");
      shader.fragmentShader = "varying vec2 vOnFloor;\n" + shader.fragmentShader.replace("#include <dithering_fragment>",
        "#include <dithering_fragment>\ngl_FragColor.a *= 1.0 - smoothstep(" + (0.3 * size).toFixed(3) + ", " +
        (0.95 * size).toFixed(3) + ", length(vOnFloor));");
    };
    shade.position.set(film.focus[0], film.focus[1], film.floor - 0.001);
    shade.receiveShadow = true;
    scene.add(shade);
    const pitch = film.reach > 1.5 ? 0.5 : 0.1, count = Math.min(120, Math.ceil(4 * film.reach / pitch)), lines = [];
    const cx = Math.round(film.focus[0] / pitch) * pitch, cy = Math.round(film.focus[1] / pitch) * pitch;
    for (let i = -count; i <= count; i += 1) {
      lines.push(cx + i * pitch, cy - count * pitch, 0, cx + i * pitch, cy + count * pitch, 0);
      lines.push(cx - count * pitch, cy + i * pitch, 0, cx + count * pitch, cy + i * pitch, 0);
    }
    const geometry = new T.BufferGeometry();
    geometry.setAttribute("position", new T.Float32BufferAttribute(lines, 3));
    const grid = new T.LineSegments(geometry, new T.LineBasicMaterial({ color: 0x6b7684, transparent: true, opacity: 0.16 }));
    grid.position.z = film.floor;
    scene.add(grid);
  }
  function lights(scene, film, plain) {
    const space = film.place === "space", key = new T.DirectionalLight(0xfff4e6, space ? 1.15 : 0.95);
    const r = film.reach, f = film.focus;
    key.position.set(f[0] + 2.2 * r, f[1] - 2.6 * r, f[2] + 4.2 * r);
    key.target.position.set(f[0], f[1], f[2]);
    key.castShadow = true;
    key.shadow.mapSize.set(plain ? 1024 : 2048, plain ? 1024 : 2048);
    Object.assign(key.shadow.camera, { left: -1.5 * r, right: 1.5 * r, top: 1.5 * r, bottom: -1.5 * r, near: 0.5 * r, far: 12 * r });
    key.shadow.bias = -0.0004;
    key.shadow.normalBias = 0.004 * r;
    key.shadow.radius = 4;
    const fill = new T.HemisphereLight(space ? 0x9fb6d8 : 0xf4f7fb, space ? 0x1d3d6e : 0x8b8f96, (space ? 0.2 : 0.18) + (plain ? 0.75 : 0));
    const rim = new T.DirectionalLight(space ? 0x8fb8ff : 0xdfe9ff, space ? 0.5 : 0.2);
    rim.position.set(f[0] - 3 * r, f[1] + 3 * r, f[2] + 1.2 * r);
    rim.target.position.set(f[0], f[1], f[2]);
    scene.add(key, key.target, fill, rim, rim.target);
  }
  function clearing(viewer) {
    // What the card on the left and the bar below leave of the window: the camera's middle is moved into the middle of that.
    const w = window.innerWidth, h = window.innerHeight, card = document.querySelector("header.card"), bar = document.getElementById("bar");
    const wide = card && card.offsetWidth < 0.5 * w, left = wide ? card.offsetLeft + card.offsetWidth : 0;
    const low = bar && !bar.hidden ? h - bar.offsetTop : 0, top = card && !wide ? card.offsetTop + card.offsetHeight : 0;
    viewer.camera.setViewOffset(w, h, -left / 2, (low - top) / 2, w, h);
    return Math.max(0.2, Math.min((w - left) / h, (h - low - top) / h));
  }
  function look(viewer, focus, reach, direction) {
    viewer.set_3d_pane_size();
    // The viewer's camera sits in a frame turned by a quarter about x: its (x, y, z) is the world's (x, -z, y).
    const camera = viewer.camera, local = function (p) { return [p[0], p[2], -p[1]]; };
    const n = Math.hypot(direction[0], direction[1], direction[2]);
    const half = Math.tan(camera.fov * Math.PI / 360) * clearing(viewer);
    const distance = 0.8 * reach / Math.sin(Math.atan(half));
    const eye = focus.map(function (v, i) { return v + distance * direction[i] / n; });
    camera.position.set.apply(camera.position, local(eye));
    viewer.controls.target.set.apply(viewer.controls.target, local(focus));
    viewer.controls.update();
    viewer.set_dirty();
  }
  function drawnInSoftware(renderer) {
    const gl = renderer.getContext(), about = gl.getExtension("WEBGL_debug_renderer_info");
    return about !== null && /swiftshader|llvmpipe|software|basic render/i.test(gl.getParameter(about.UNMASKED_RENDERER_WEBGL));
  }
  function build(viewer, film, full) {
    // Without a graphics card reflections cost seconds a page: it does without them (unless the address asks).
    const renderer = viewer.renderer, scene = viewer.scene, space = film.place === "space";
    const plain = !full && drawnInSoftware(renderer);
    renderer.outputEncoding = T.sRGBEncoding;
    renderer.toneMapping = T.ACESFilmicToneMapping;
    renderer.toneMappingExposure = space ? 1.05 : 1.12;
    renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    viewer.hide_background();  // the page's own shows through
    renderer.setClearColor(0x000000, 0);
    if (!plain) {
      const generator = new T.PMREMGenerator(renderer);
      scene.environment = generator.fromScene(room(space), 0.03).texture;
      generator.dispose();
    }
    viewer.camera.fov = 34;
    viewer.camera.near = Math.max(0.002, 0.004 * film.reach);
    viewer.camera.far = 200;
    lights(scene, film, plain);
    if (space) stars(scene); else ground(scene, film);
  }
  function dull(viewer) {
    // Metal without anything to reflect is black.
    if (viewer.scene.environment) return;
    viewer.scene.traverse(function (o) { if (o.material && o.material.metalness > 0.2) o.material.metalness = 0.2; });
  }
  return { build: build, dull: dull, look: look, clear: clearing };
})();
