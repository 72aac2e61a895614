// The belted effective-mass ellipsoid: the surface r(n) = n / (n^T G n) for the mobility G of the moment.
window.SpacerobotMass = (function () {
  "use strict";
  const T = MeshCat.THREE, RINGS = 28, SEGMENTS = 56;

  function Ellipsoid(scene, scale, limit, dark) {
    const count = (RINGS + 1) * (SEGMENTS + 1), directions = [], faces = [], lines = [];
    for (let i = 0; i <= RINGS; i += 1) {
      for (let j = 0; j <= SEGMENTS; j += 1) {
        const p = Math.PI * i / RINGS, a = 2 * Math.PI * j / SEGMENTS;
        directions.push(Math.sin(p) * Math.cos(a), Math.sin(p) * Math.sin(a), Math.cos(p));
        const here = i * (SEGMENTS + 1) + j;
        if (i < RINGS && j < SEGMENTS) {
          const below = here + SEGMENTS + 1;
          faces.push(here, below, below + 1, here, below + 1, here + 1);
          if (i % 4 === 0) lines.push(here, here + 1);
          if (j % 8 === 0) lines.push(here, below);
        }
      }
    }
    this.directions = directions;
    this.scale = scale;
    this.limit = limit;
    this.points = new T.BufferAttribute(new Float32Array(3 * count), 3);
    this.surface = new T.BufferGeometry();
    this.surface.setAttribute("position", this.points);
    this.surface.setIndex(faces);
    const wire = new T.BufferGeometry();
    wire.setAttribute("position", this.points);
    wire.setIndex(lines);
    this.group = new T.Group();
    const skin = { color: dark ? 0x7a3fb0 : 0x6b2fa3, transparent: true, depthWrite: false, roughness: 0.4, metalness: 0 };
    const inner = new T.Mesh(this.surface, new T.MeshStandardMaterial(Object.assign({ side: T.BackSide, opacity: 0.22 }, skin)));
    const outer = new T.Mesh(this.surface, new T.MeshStandardMaterial(Object.assign({ side: T.FrontSide, opacity: 0.3 }, skin)));
    inner.renderOrder = 1;
    outer.renderOrder = 2;
    this.group.add(inner, outer,
      new T.LineSegments(wire, new T.LineBasicMaterial({ color: dark ? 0xc79be8 : 0x5b2a8c, transparent: true, opacity: dark ? 0.5 : 0.35, depthWrite: false })));
    scene.add(this.group);
  }
  Ellipsoid.prototype.set = function (centre, g) {
    const d = this.directions, out = this.points.array;
    for (let k = 0; k < d.length; k += 3) {
      const x = d[k], y = d[k + 1], z = d[k + 2];
      const mobility = g[0] * x * x + g[4] * y * y + g[8] * z * z + 2 * (g[1] * x * y + g[2] * x * z + g[5] * y * z);
      const r = mobility > 0 ? Math.min(this.scale / mobility, this.limit) : this.limit;
      out[k] = r * x;
      out[k + 1] = r * y;
      out[k + 2] = r * z;
    }
    this.points.needsUpdate = true;
    this.surface.computeVertexNormals();
    this.surface.computeBoundingSphere();
    this.group.position.set(centre[0], centre[1], centre[2]);
  };
  return { Ellipsoid: Ellipsoid };
})();
