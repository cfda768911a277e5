// The table of both meshes' numbers.

import { short } from 'viewer/colours.js';

/** Names as in the study's tables, and what a reader is told. */
const ROWS = [
  ['spacing', 'Spacing'],
  ['triangles', 'Triangles'],
  ['vertices', 'Vertices'],
  ['radius_ratio_mean', 'Radius ratio, mean'],
  ['min_angle_deg_min', 'Smallest angle', '°'],
  ['distance_mean', 'Distance to the isosurface, mean'],
  ['distance_max', 'Distance to the isosurface, largest'],
  ['distance_to_mesh_max', 'Distance back to the mesh, largest'],
  ['normal_error_mean_deg', 'Error of normals, mean', '°'],
  ['normal_error_q95_deg', 'Error of normals, 95 %', '°'],
  ['euler_characteristic', 'Euler characteristic'],
  ['components', 'Components'],
  ['boundary_edges', 'Boundary edges'],
  ['non_manifold_edges', 'Non-manifold edges'],
  ['self_intersections', 'Triangles through each other'],
  ['difference_max', 'Distance to the other mesh, largest'],
];

/** Fills the table's body from two lists of numbers, either of which may be missing. A row that neither has is left out. */
export function showNumbers(body, sides) {
  const known = (name) => sides.some((numbers) => numbers?.[name] !== undefined && numbers?.[name] !== null);
  body.replaceChildren(...ROWS.filter(([name]) => known(name)).map(([name, label, unit = '']) => {
    const row = document.createElement('tr');
    row.dataset.name = name;
    const head = document.createElement('th');
    head.scope = 'row';
    head.textContent = label;
    const cells = sides.map((numbers) => {
      const cell = document.createElement('td');
      const value = numbers?.[name];
      cell.textContent = numbers ? `${short(value)}${typeof value === 'number' ? unit : ''}` : 'no mesh';
      if (typeof value === 'number') cell.dataset.value = value;
      return cell;
    });
    row.append(head, ...cells);
    return row;
  }));
}
