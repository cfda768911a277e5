// Two models from one camera, drawn as the study's turntables are: same light, colours and edges.
// The formulas are those of crates/isostudy-raster/src/shading.rs and turntable.rs.

import {
  BufferAttribute, BufferGeometry, Color, ColorManagement, DoubleSide, GLSL3, Mesh, PerspectiveCamera, Scene, ShaderMaterial, Vector3, WebGLRenderer,
} from './three.module.min.js';

const VERTEX = `
out vec3 vNormal, vCorner;
void main() {
  vNormal = normal;
  vCorner = vec3(gl_VertexID % 3 == 0, gl_VertexID % 3 == 1, gl_VertexID % 3 == 2);
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

// An interpolated normal is taken as it comes, shorter than 1.
const FRAGMENT = `
precision highp float;
in vec3 vNormal, vCorner;
out vec4 colour;
uniform vec3 light, lit, shade, highlight, wire;
uniform float ambient, halfWire;
uniform bool hasWires;
void main() {
  float d = -dot(vNormal, light);
  vec3 front = mix(lit, highlight, d * d * d);
  vec3 back = mix(shade, shade * 0.1, -d);
  vec3 shown = mix(clamp(mix(back, front, clamp(d, 0.0, 1.0)), 0.0, 1.0), lit, ambient);
  if (hasWires) {
    vec3 away = vCorner * inversesqrt(max(dFdx(vCorner) * dFdx(vCorner) + dFdy(vCorner) * dFdy(vCorner), vec3(1e-12)));
    float on = 1.0 - smoothstep(halfWire - 0.5, halfWire + 0.5, min(away.x, min(away.y, away.z)));
    shown = mix(shown, wire, on);
  }
  colour = vec4(shown, 1.0);
}`;

ColorManagement.enabled = false;

const GLB = 0x46546c67;
// Component types of glTF.
const LISTS = { 5120: Int8Array, 5121: Uint8Array, 5122: Int16Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array };

/** The models of a pair's file, left and right, and the camera that it begins with. */
export function read(bytes) {
  const view = new DataView(bytes);
  if (view.getUint32(0, true) !== GLB) throw new Error('no binary glTF');
  const length = view.getUint32(12, true);
  const gltf = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 20, length)));
  const begin = 28 + length;

  /** Every component of an accessor, `wide` to an element. */
  function numbers(index, wide) {
    const { bufferView, componentType, byteOffset = 0, count } = gltf.accessors[index];
    const { byteOffset: start = 0, byteStride } = gltf.bufferViews[bufferView];
    const List = LISTS[componentType];
    const stride = (byteStride ?? wide * List.BYTES_PER_ELEMENT) / List.BYTES_PER_ELEMENT;
    const list = new List(bytes, begin + start + byteOffset, (count - 1) * stride + wide);
    const all = new Float64Array(wide * count);
    for (let i = 0; i < count; i += 1) for (let k = 0; k < wide; k += 1) all[wide * i + k] = list[stride * i + k];
    return all;
  }

  const { nodes, extras } = gltf.scenes[gltf.scene];
  const models = nodes.map((node) => {
    const { mesh, translation, scale } = gltf.nodes[node];
    if (mesh === undefined) return { corners: new Float32Array(), normals: new Float32Array(), look: 'smooth' };
    const { attributes, indices } = gltf.meshes[mesh].primitives[0];
    const { look } = gltf.meshes[mesh].extras;
    const triangles = numbers(indices, 1);
    const [steps, directions] = [numbers(attributes.POSITION, 3), numbers(attributes.NORMAL, 3)];
    const [corners, normals] = [new Float32Array(3 * triangles.length), new Float32Array(3 * triangles.length)];
    triangles.forEach((vertex, i) => {
      const along = [0, 1, 2].map((k) => directions[3 * vertex + k]);
      const size = Math.hypot(...along) || 1;
      for (let k = 0; k < 3; k += 1) {
        corners[3 * i + k] = steps[3 * vertex + k] * scale[k] + translation[k];
        normals[3 * i + k] = along[k] / size;
      }
    });
    if (look === 'flat') flatten(corners, normals);
    return { corners, normals, look };
  });
  return { models, camera: extras.camera };
}

/** One normal a triangle, from its corners. */
function flatten(corners, normals) {
  for (let t = 0; t < corners.length; t += 9) {
    const [u, v] = [3, 6].map((far) => [0, 1, 2].map((k) => corners[t + far + k] - corners[t + k]));
    const across = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const size = Math.hypot(...across) || 1;
    for (let i = 0; i < 9; i += 1) normals[t + i] = across[i % 3] / size;
  }
}

/** From the middle to a camera of this azimuth and elevation. */
export const direction = ({ azimuth, elevation }) => new Vector3(
  Math.cos(elevation) * Math.cos(azimuth), Math.cos(elevation) * Math.sin(azimuth), Math.sin(elevation),
);

/** Right, up and forward of a camera, across each other. */
function axes(camera) {
  const forward = direction(camera).negate();
  const right = forward.clone().cross(new Vector3(0, 0, 1)).normalize();
  return [right, right.clone().cross(forward), forward];
}

// One for all pairs: a browser has few of them.
let renderer = null;

/**
 * Both models of a file, to be drawn side by side on one canvas. `shading` is the study's. `lost` is called when the browser takes
 * the canvas away. Throws where the browser draws no models.
 */
export function views(bytes, shading, lost) {
  const { models, camera: start } = read(bytes);
  renderer ??= new WebGLRenderer({ antialias: true });
  const canvas = renderer.domElement;
  renderer.setPixelRatio(1);
  renderer.setScissorTest(true);
  renderer.autoClear = false;
  renderer.setClearColor(new Color(...shading.background));
  const colour = (of) => ({ value: new Vector3(...of) });
  let radius = 1e-3;
  const scenes = models.map(({ corners, normals, look }) => {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(corners, 3));
    geometry.setAttribute('normal', new BufferAttribute(normals, 3));
    for (let i = 0; i < corners.length; i += 3) {
      radius = Math.max(radius, Math.hypot(corners[i], corners[i + 1], corners[i + 2] - start.middle_z));
    }
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      side: DoubleSide,
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: {
        light: { value: new Vector3() },
        lit: colour(shading.lit),
        shade: colour(shading.shade),
        highlight: colour(shading.highlight),
        wire: colour(shading.wire),
        ambient: { value: shading.ambient },
        halfWire: { value: 0.5 },
        hasWires: { value: look === 'smooth-wireframe' },
      },
    });
    const mesh = new Mesh(geometry, material);
    mesh.frustumCulled = false;
    const scene = new Scene();
    scene.add(mesh);
    return { scene, mesh };
  });
  const first = axes(start);
  const light = new Vector3(...shading.light);
  const seen = new PerspectiveCamera();
  seen.up.set(0, 0, 1);

  const onLost = () => {
    renderer = null;
    lost();
  };
  canvas.addEventListener('webglcontextlost', onLost, { once: true });

  return {
    canvas,
    /** The camera of the turntable's first frame: azimuth and elevation in radians, distance, and what stays. */
    start,
    /** Draws both as a camera sees them, each `width` by `height` pixels large. */
    draw(camera, width, height) {
      if (canvas.width !== 2 * width || canvas.height !== height) renderer.setSize(2 * width, height, false);
      const away = direction(camera).multiplyScalar(camera.distance);
      seen.position.copy(away).add(new Vector3(0, 0, start.middle_z));
      seen.lookAt(0, 0, start.middle_z);
      seen.fov = (start.vertical_fov_rad * 180) / Math.PI;
      seen.aspect = width / height;
      seen.near = Math.max((camera.distance - radius) * 0.5, radius * 1e-3);
      seen.far = camera.distance + 2 * radius;
      seen.updateProjectionMatrix();
      seen.updateMatrixWorld();
      const turned = new Vector3();
      axes(camera).forEach((axis, i) => turned.addScaledVector(axis, first[i].dot(light)));
      scenes.forEach(({ scene, mesh }, i) => {
        mesh.material.uniforms.light.value.copy(shading.follows ? turned : light);
        mesh.material.uniforms.halfWire.value = Math.max(0.5, 0.5 * shading.wire_width * height);
        renderer.setViewport(i * width, 0, width, height);
        renderer.setScissor(i * width, 0, width, height);
        renderer.clear();
        renderer.render(scene, seen);
      });
    },
    leave() {
      canvas.removeEventListener('webglcontextlost', onLost);
      for (const { mesh } of scenes) {
        mesh.geometry.dispose();
        mesh.material.dispose();
      }
    },
  };
}
