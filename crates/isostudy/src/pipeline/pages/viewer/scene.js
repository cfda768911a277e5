// Two views of two surfaces on one canvas, from one camera.

import {
  BufferAttribute, BufferGeometry, Color, ColorManagement, Mesh, PerspectiveCamera, Scene, Sphere, Spherical, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { material } from 'viewer/material.js';

/** Radians that an arrow key turns. */
const TURN = Math.PI / 24;
/** What one press of + or - divides or multiplies the distance by. */
const STEP = 1.15;

/** Room around the surfaces at first. */
const MARGIN = 1.04;
/** In how many directions, and at how many heights, a surface is looked at for its size. */
const TURNS = 24;
const SLICES = 24;

/** Of slices of a surface, by height: the farthest distance from the vertical through a middle, and the height above it. */
function outline(geometry, center) {
  const { array } = geometry.attributes.position;
  let [low, high] = [Infinity, -Infinity];
  for (let i = 2; i < array.length; i += 3) {
    low = Math.min(low, array[i]);
    high = Math.max(high, array[i]);
  }
  const radii = new Array(SLICES).fill(0);
  const slice = (height) => Math.min(SLICES - 1, Math.floor((SLICES * (height - low)) / (high - low || 1)));
  for (let i = 0; i < array.length; i += 3) {
    const at = slice(array[i + 2]);
    radii[at] = Math.max(radii[at], Math.hypot(array[i] - center.x, array[i + 1] - center.y));
  }
  const edge = (place) => low + ((high - low) * place) / SLICES - center.z;
  return radii.flatMap((radius, place) => (radius > 0 ? [[radius, edge(place)], [radius, edge(place + 1)]] : []));
}

ColorManagement.enabled = false;

export class Views {
  /** `panes` are the two elements over whose places the canvas shows the surfaces.
      Throws where the browser has no WebGL 2. */
  constructor(canvas, panes, catalogue) {
    this.canvas = canvas;
    this.panes = panes;
    this.catalogue = catalogue;
    this.renderer = new WebGLRenderer({ canvas, antialias: true });
    this.renderer.setScissorTest(true);
    this.renderer.setClearColor(new Color(...catalogue.shading.background));
    this.renderer.autoClear = false;
    this.sides = panes.map(() => {
      const scene = new Scene();
      const mesh = new Mesh(new BufferGeometry(), material(catalogue.shading));
      mesh.frustumCulled = false;
      mesh.visible = false;
      scene.add(mesh);
      return { scene, mesh };
    });
    this.camera = new PerspectiveCamera();
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    // The controls take every finger. One that moves up or down is left to the page, which is higher than a phone's screen.
    canvas.style.touchAction = 'pan-y';
    this.controls.addEventListener('change', () => this.later());
    new ResizeObserver(() => this.later()).observe(canvas);
    canvas.addEventListener('webglcontextrestored', () => this.later());
  }

  /** Looks from where a study's animations of an object begin, as near as shows all of both surfaces in both panes. */
  look(object) {
    this.fov = object.camera.vertical_fov_rad;
    const { camera, controls } = this;
    const { center } = this.around();
    const up = this.catalogue.elevation_rad;
    const direction = new Vector3(Math.cos(up), Math.cos(up), Math.sin(up)).normalize();
    controls.target.copy(center);
    camera.position.copy(center).addScaledVector(direction, this.nearest(center, direction));
    camera.lookAt(center);
    // The light stands to the camera as it does to that of the first frame.
    camera.updateMatrixWorld();
    const light = new Vector3(...this.catalogue.shading.light);
    this.light = light.applyQuaternion(camera.quaternion.clone().invert());
    controls.update();
    this.later();
  }

  /** How far from the middle the camera shows all of both surfaces in both panes, however they are turned about the vertical. */
  nearest(center, direction) {
    const outlines = this.sides.filter((side) => side.mesh.visible).flatMap((side) => outline(side.mesh.geometry, center));
    if (outlines.length === 0) return 1 / Math.sin(this.fov / 2);
    const right = new Vector3(-direction.y, direction.x, 0).normalize();
    const upwards = new Vector3().crossVectors(direction, right);
    let most = 0;
    for (const { clientWidth, clientHeight } of this.panes) {
      const aspect = clientWidth / clientHeight;
      const tangent = Math.tan(this.fov / 2) / Math.min(aspect, 1);
      for (const [radius, height] of outlines) {
        for (let step = 0; step < TURNS; step += 1) {
          const angle = (2 * Math.PI * step) / TURNS;
          const at = new Vector3(radius * Math.cos(angle), radius * Math.sin(angle), height);
          const [x, y] = [Math.abs(at.dot(right)) / aspect, Math.abs(at.dot(upwards))];
          most = Math.max(most, at.dot(direction) + Math.max(x, y) / tangent);
        }
      }
    }
    return most * MARGIN;
  }

  /** A ball that holds both surfaces. */
  around() {
    const ball = new Sphere();
    for (const { mesh } of this.sides.filter((side) => side.mesh.visible)) ball.union(mesh.geometry.boundingSphere);
    return { center: ball.center, radius: ball.isEmpty() ? 1 : ball.radius };
  }

  /** Shows a surface in a pane, or nothing. */
  put(side, surface) {
    const at = this.sides[side];
    at.mesh.visible = Boolean(surface);
    if (!surface || at.surface === surface) return;
    at.surface = surface;
    const { positions, normals, triangles } = surface;
    const corners = new BufferGeometry();
    const spread = (of) => {
      const each = new Float32Array(3 * triangles.length);
      for (let i = 0; i < triangles.length; i += 1) {
        const v = 3 * triangles[i];
        each[3 * i] = of[v];
        each[3 * i + 1] = of[v + 1];
        each[3 * i + 2] = of[v + 2];
      }
      return new BufferAttribute(each, 3);
    };
    corners.setAttribute('position', spread(positions));
    corners.setAttribute('normal', spread(normals));
    corners.setAttribute('value', new BufferAttribute(new Float32Array(triangles.length), 1));
    at.mesh.geometry.dispose();
    at.mesh.geometry = corners;
    corners.computeBoundingSphere();
  }

  /** Colours a pane by numbers of triangles or vertices, on a scale from 0 to `most`; by its material without numbers. */
  colour(side, mode, numbers, most) {
    const { mesh, surface } = this.sides[side];
    const { uniforms } = mesh.material;
    uniforms.isFlat.value = Boolean(mode.flat);
    uniforms.hasWires.value = Boolean(mode.wires);
    uniforms.isColoured.value = Boolean(numbers);
    uniforms.brightAtZero.value = mode.good === 'small';
    uniforms.most.value = most || 1;
    if (!numbers || !surface) return;
    const { value } = mesh.geometry.attributes;
    const perTriangle = 3 * numbers.length === surface.triangles.length;
    for (let i = 0; i < surface.triangles.length; i += 1) {
      const number = numbers[perTriangle ? Math.floor(i / 3) : surface.triangles[i]];
      // The sign is left for what has none.
      value.array[i] = Number.isNaN(number) ? -1 : number;
    }
    value.needsUpdate = true;
  }

  /** Turns the camera by keys: to the right and up, in steps. */
  turn(right, up) {
    const { camera, controls } = this;
    // Spherical has y for up.
    const offset = camera.position.clone().sub(controls.target);
    const at = new Spherical().setFromVector3(new Vector3(offset.y, offset.z, offset.x));
    at.theta += right * TURN;
    at.phi -= up * TURN;
    at.makeSafe();
    const { x, y, z } = new Vector3().setFromSpherical(at);
    camera.position.copy(controls.target).add(new Vector3(z, x, y));
    controls.update();
    this.later();
  }

  /** Moves the camera nearer by so many steps. */
  nearer(steps) {
    const { camera, controls } = this;
    camera.position.sub(controls.target).multiplyScalar(STEP ** -steps).add(controls.target);
    controls.update();
    this.later();
  }

  /** Draws at the next frame, once. */
  later() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw();
    });
  }

  draw() {
    if (!this.light) return;
    const { renderer, canvas, camera } = this;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (width === 0 || height === 0) return;
    const size = [width, height, Math.min(devicePixelRatio, 2)].join(' ');
    // A new size clears the canvas and takes new memory.
    if (size !== this.size) {
      renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
      renderer.setSize(width, height, false);
      this.size = size;
    }
    renderer.setScissor(0, 0, width, height);
    renderer.setViewport(0, 0, width, height);
    renderer.clear();
    const { center, radius } = this.around();
    const away = camera.position.distanceTo(center);
    camera.near = Math.max((away - radius) * 0.5, radius * 1e-3);
    camera.far = away + 2 * radius;
    camera.updateMatrixWorld();
    const light = this.light.clone().applyQuaternion(camera.quaternion);
    const corner = canvas.getBoundingClientRect();
    this.panes.forEach((pane, i) => {
      const at = pane.getBoundingClientRect();
      const place = [at.left - corner.left, corner.bottom - at.bottom, at.width, at.height];
      renderer.setScissor(...place);
      renderer.setViewport(...place);
      camera.aspect = at.width / at.height;
      // In a pane that is higher than wide the field of view is that of the width.
      const tangent = Math.tan(this.fov / 2) / Math.min(camera.aspect, 1);
      camera.fov = (2 * Math.atan(tangent) * 180) / Math.PI;
      camera.updateProjectionMatrix();
      const { scene, mesh } = this.sides[i];
      mesh.material.uniforms.light.value.copy(light);
      renderer.render(scene, camera);
    });
    canvas.dataset.drawn = Number(canvas.dataset.drawn ?? 0) + 1;
  }
}
