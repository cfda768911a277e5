// How surfaces are drawn: the study's own shading, or colours for numbers, with or without edges.

import { DataTexture, DoubleSide, GLSL3, LinearFilter, RGBAFormat, ShaderMaterial, Vector3 } from 'three';
import { mapBytes } from 'viewer/colours.js';

const VERTEX = `
in float value;
out vec3 vNormal, vPlace, vCorner;
out float vValue;
void main() {
  vNormal = normal;
  vPlace = position;
  vCorner = vec3(gl_VertexID % 3 == 0, gl_VertexID % 3 == 1, gl_VertexID % 3 == 2);
  vValue = value;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

// The formulas are those of crates/isostudy-raster/src/shading.rs. The side of an open surface that is seen from behind is lit as well.
const FRAGMENT = `
precision highp float;
in vec3 vNormal, vPlace, vCorner;
in float vValue;
out vec4 colour;
uniform vec3 light, lit, shade, highlight, wire;
uniform float ambient, most;
uniform bool isFlat, hasWires, isColoured, brightAtZero;
uniform sampler2D map;
void main() {
  vec3 outward = normalize(cross(dFdx(vPlace), dFdy(vPlace)));
  vec3 n = isFlat ? outward : normalize(vNormal) * (dot(vNormal, outward) < 0.0 && !gl_FrontFacing ? -1.0 : 1.0);
  float d = -dot(n, light);
  vec3 front = mix(lit, highlight, d * d * d);
  vec3 back = mix(shade, shade * 0.1, -d);
  vec3 shown = mix(clamp(mix(back, front, clamp(d, 0.0, 1.0)), 0.0, 1.0), lit, ambient);
  if (isColoured) {
    float place = clamp(vValue / most, 0.0, 1.0);
    vec3 of = texture(map, vec2(((brightAtZero ? 1.0 - place : place) * 255.0 + 0.5) / 256.0, 0.5)).rgb;
    float directed = 0.8 + 0.2 * clamp(0.5 + 0.5 * d / length(light), 0.0, 1.0);
    shown = (vValue < 0.0 ? vec3(0.5) : of) * mix(directed, 1.0, ambient);
  }
  if (hasWires) {
    vec3 near = smoothstep(vec3(0.0), 1.1 * fwidth(vCorner), vCorner);
    shown = mix(mix(shown, wire, 0.85), shown, min(near.x, min(near.y, near.z)));
  }
  colour = vec4(shown, 1.0);
}`;

/** Half of a turned object would be dark without some light from all sides. */
const LEAST_AMBIENT = 0.2;

/** A material with a study's colours. */
export function material(shading) {
  const map = new DataTexture(mapBytes(), 256, 1, RGBAFormat);
  map.minFilter = LinearFilter;
  map.magFilter = LinearFilter;
  map.needsUpdate = true;
  const colour = (of) => ({ value: new Vector3(...of) });
  return new ShaderMaterial({
    glslVersion: GLSL3,
    side: DoubleSide,
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    uniforms: {
      light: { value: new Vector3() },
      lit: colour(shading.lit),
      shade: colour(shading.shade),
      highlight: colour(shading.highlight),
      wire: colour([0.03, 0.02, 0.05]),
      ambient: { value: Math.max(shading.ambient ?? 0, LEAST_AMBIENT) },
      most: { value: 1 },
      isFlat: { value: false },
      hasWires: { value: false },
      isColoured: { value: false },
      brightAtZero: { value: false },
      map: { value: map },
    },
  });
}
