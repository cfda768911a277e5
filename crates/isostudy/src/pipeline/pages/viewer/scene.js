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
/** Corners that a surface is looked at for its size: of more, some are left out. */
const CORNERS = 20000;
/** How often the middle is moved: each time what is off is a small part of what was. */
const STEPS = 4;

/** The smallest and the largest of what is measured. */
function ends(all, measure) {
  return all.reduce(([low, high], of) => [Math.min(low, measure(of)), Math.max(high, measure(of))], [Infinity, -Infinity]);
}

/** Keeps one finger's moves from the controls until it goes sideways: the browser says only after the first that it scrolls. */
function leaveUpAndDown(canvas) {
  const fingers = new Map();
  let turns = false;
  canvas.addEventListener('pointerdown', ({ pointerType, pointerId, clientX, clientY }) => {
    if (pointerType !== 'touch') return;
    fingers.set(pointerId, [clientX, clientY]);
    turns = fingers.size > 1;
  }, true);
  canvas.addEventListener('pointermove', (event) => {
    const start = fingers.get(event.pointerId);
    if (!start || turns) return;
    const [across, along] = [Math.abs(event.clientX - start[0]), Math.abs(event.clientY - start[1])];
    turns = across > along;
    if (!turns) event.stopImmediatePropagation();
  }, true);
  for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, ({ pointerId }) => fingers.delete(pointerId), true);
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
    leaveUpAndDown(canvas);
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
    const { target, distance } = this.fitted(center, direction);
    controls.target.copy(target);
    camera.position.copy(target).addScaledVector(direction, distance);
    camera.lookAt(target);
    // The light stands to the camera as it does to that of the first frame.
    camera.updateMatrixWorld();
    const light = new Vector3(...this.catalogue.shading.light);
    this.light = light.applyQuaternion(camera.quaternion.clone().invert());
    controls.update();
    this.later();
  }

  /** Where to look, and from how far, such that both surfaces just fit into both panes, each in the middle of its pane. */
  fitted(center, direction) {
    const right = new Vector3(-direction.y, direction.x, 0).normalize();
    const upwards = new Vector3().crossVectors(direction, right);
    const seen = this.sides.filter((side) => side.mesh.visible).flatMap(({ mesh }) => {
      const { array, count } = mesh.geometry.attributes.position;
      const every = Math.ceil(count / CORNERS);
      const corners = [];
      for (let i = 0; i < count; i += every) {
        const at = new Vector3().fromArray(array, 3 * i).sub(center);
        corners.push([at.dot(right), at.dot(upwards), at.dot(direction)]);
      }
      return corners;
    });
    if (seen.length === 0) return { target: center, distance: 1 / Math.sin(this.fov / 2) };
    // The narrower pane of two decides; both are as wide and as high to a pixel.
    const { clientWidth, clientHeight } = this.panes[0];
    const aspect = clientWidth / clientHeight || 1;
    const tangent = Math.tan(this.fov / 2) / Math.min(aspect, 1);
    let [x, y, distance] = [0, 0, 0];
    for (let step = 0; step < STEPS; step += 1) {
      [, distance] = ends(seen, ([r, u, d]) => d + Math.max(Math.abs(r - x) / aspect, Math.abs(u - y)) / tangent);
      const [left, most] = ends(seen, ([r, , d]) => (r - x) / (distance - d));
      const [low, high] = ends(seen, ([, u, d]) => (u - y) / (distance - d));
      x += ((left + most) / 2) * distance;
      y += ((low + high) / 2) * distance;
    }
    const target = center.clone().addScaledVector(right, x).addScaledVector(upwards, y);
    return { target, distance: MARGIN * distance };
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
    const { positions, normals, triangles, creased } = surface;
    const corners = new BufferGeometry();
    const spread = (of, indices = triangles) => {
      const each = new Float32Array(3 * triangles.length);
      for (let i = 0; i < triangles.length; i += 1) {
        const v = 3 * indices[i];
        each[3 * i] = of[v];
        each[3 * i + 1] = of[v + 1];
        each[3 * i + 2] = of[v + 2];
      }
      return new BufferAttribute(each, 3);
    };
    corners.setAttribute('position', spread(positions));
    at.normals = { smooth: spread(normals), creased: spread(normals, creased) };
    corners.setAttribute('value', new BufferAttribute(new Float32Array(triangles.length), 1));
    at.mesh.geometry.dispose();
    at.mesh.geometry = corners;
    corners.computeBoundingSphere();
  }

  /** Shows a pane in a mode: colours it by numbers of triangles or vertices, on a scale from 0 to `most`; by its material without numbers. */
  colour(side, mode, numbers, most) {
    const { mesh, surface } = this.sides[side];
    const { uniforms } = mesh.material;
    if (surface) mesh.geometry.setAttribute('normal', this.sides[side].normals[mode.creased ? 'creased' : 'smooth']);
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
