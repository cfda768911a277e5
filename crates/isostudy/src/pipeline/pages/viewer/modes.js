// What can be shown, in the order of the digits that choose it.

/** `values` says where each mode's numbers are from; `good` is the end of the scale that is bright. */
export const MODES = [
  { id: 'smooth', label: 'Smooth', says: 'shading by the normals of vertices' },
  { id: 'creased', label: 'Creased', says: 'shading by the normals of vertices, sharp at creases', creased: true },
  { id: 'flat', label: 'Flat', says: 'shading by triangles', flat: true },
  { id: 'wires', label: 'Wires', says: 'smooth shading with the edges of triangles', wires: true },
  { id: 'quality', label: 'Quality', says: 'radius ratio of triangles', flat: true, values: 'quality', good: 'large', most: 1 },
  { id: 'distance', label: 'Distance', says: 'distance of triangles to the isosurface', flat: true, values: 'distance', good: 'small' },
  { id: 'normals', label: 'Normals', says: 'angle between normals of mesh and field', unit: '°', values: 'angle', good: 'small' },
  { id: 'difference', label: 'Difference', says: 'distance of triangles to the other mesh', flat: true, values: 'difference', good: 'small', nought: 'the same' },
];

export const mode = (id) => MODES.find((of) => of.id === id);
