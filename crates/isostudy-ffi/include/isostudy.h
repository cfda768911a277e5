#ifndef ISOSTUDY_H
#define ISOSTUDY_H

/* Made by cbindgen from the sources of isostudy-ffi. Change those. */

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

/*
 How a call ended.
 */
typedef enum isostudy_status {
  /*
   Done.
   */
  ISOSTUDY_STATUS_OK = 0,
  /*
   An argument is not what it must be: a null pointer, a name that there is not.
   */
  ISOSTUDY_STATUS_ARGUMENT = 1,
  /*
   The extraction is not possible as it was asked for.
   */
  ISOSTUDY_STATUS_EXTRACT = 2,
  /*
   The library has a fault. The object may be freed, and not be used otherwise.
   */
  ISOSTUDY_STATUS_PANIC = 3,
} isostudy_status;

/*
 Where normals come from.
 */
typedef enum isostudy_normals {
  /*
   There are none.
   */
  ISOSTUDY_NORMALS_NONE = 0,
  /*
   From the triangles round the vertex.
   */
  ISOSTUDY_NORMALS_TRIANGLES = 1,
  /*
   From the field's values round the vertex. Needs a field.
   */
  ISOSTUDY_NORMALS_FIELD = 2,
  /*
   From the samples round the vertex, for less time than those of triangles. Needs samples, chunks of one level, and marching cubes or
   surface nets.
   */
  ISOSTUDY_NORMALS_SAMPLES = 3,
} isostudy_normals;

/*
 Makes chunks of an endless world.
 */
typedef struct isostudy_chunks isostudy_chunks;

/*
 Makes chunks of several levels of detail, with the seams between them.
 */
typedef struct isostudy_levels isostudy_levels;

/*
 Extracts whole volumes, and keeps the last mesh.
 */
typedef struct isostudy_volume isostudy_volume;

/*
 A box of cells: all from `start` up to, and without, `end`.
 */
typedef struct isostudy_cells {
  /*
   The lowest cell.
   */
  int32_t start[3];
  /*
   One beyond the highest cell along each axis.
   */
  int32_t end[3];
} isostudy_cells;

/*
 A field by functions of the caller. They are called on the thread that extracts, and must not unwind.
 */
typedef struct isostudy_field {
  /*
   The value at a point: above the isovalue is inside. The same point has the same value each time.
   */
  float (*sample)(void *user, float x, float y, float z);
  /*
   The least and the greatest value in the box from `min` to `max`, three numbers each, and true; or false where they are not known. It
   may be null. It saves most calls of `sample`. A range that does not hold makes holes.
   */
  bool (*range)(void *user, const float *min, const float *max, float *least, float *greatest);
  /*
   Given to both functions.
   */
  void *user;
} isostudy_field;

/*
 A mesh in buffers of the object that made it, valid until the next call with that object.
 */
typedef struct isostudy_mesh {
  /*
   Three numbers a vertex.
   */
  const float *positions;
  /*
   Three numbers a vertex, of unit length and outward; null without normals.
   */
  const float *normals;
  /*
   Three numbers of vertices a triangle, counter-clockwise seen from outside.
   */
  const uint32_t *triangles;
  /*
   How many vertices there are.
   */
  size_t vertex_count;
  /*
   How many triangles there are.
   */
  size_t triangle_count;
  /*
   How many of the triangles, the last ones, are of seams between levels.
   */
  size_t seam_count;
  /*
   The lowest corner of a chunk's cells; 0 of a volume.
   */
  double origin[3];
} isostudy_mesh;

/*
 Samples on a regular grid.
 */
typedef struct isostudy_samples {
  /*
   As many as the product of the counts, x fastest.
   */
  const float *values;
  /*
   How many there are along each axis, two at least.
   */
  size_t counts[3];
  /*
   Where the first one lies.
   */
  double origin[3];
  /*
   How far the next one is along each axis.
   */
  double spacing[3];
} isostudy_samples;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/*
 Makes an object for chunks of a method, such as `"mc33"`, on a grid with a corner at `origin`, three numbers, and cubes of edge `spacing`.
 Inside is above the isovalue. `normals` is one of `isostudy_normals`. It is written to `chunks`, and freed by `isostudy_chunks_free`.

 # Safety
 Each pointer is null, which is an error, or leads to what the text says.
 */
enum isostudy_status isostudy_chunks_new(const char *method_name,
                                         const double *origin,
                                         double spacing,
                                         float isovalue,
                                         uint32_t normals,
                                         struct isostudy_chunks **chunks);

/*
 Frees the object with its buffers. Null is nothing.

 # Safety
 `chunks` is null or came from `isostudy_chunks_new`, and is not used afterwards.
 */
void isostudy_chunks_free(struct isostudy_chunks *chunks);

/*
 Makes room for so many vertices, so that no chunk with fewer allocates.

 # Safety
 `chunks` came from `isostudy_chunks_new`, and no other thread uses it.
 */
enum isostudy_status isostudy_chunks_reserve(struct isostudy_chunks *chunks, size_t vertices);

/*
 Writes the cells whose corners have the samples that a chunk needs: a box round its cells.

 # Safety
 `chunks` came from `isostudy_chunks_new`, and no other thread uses it. `window` leads to room for the answer.
 */
enum isostudy_status isostudy_chunks_window(struct isostudy_chunks *chunks,
                                            struct isostudy_cells cells,
                                            struct isostudy_cells *window);

/*
 Extracts the surface of a field in a box of cells.

 # Safety
 `chunks` came from `isostudy_chunks_new`, and no other thread uses it. `field` leads to functions that keep their promises. `mesh` leads to
 room for the answer.
 */
enum isostudy_status isostudy_chunks_extract(struct isostudy_chunks *chunks,
                                             const struct isostudy_field *field,
                                             struct isostudy_cells cells,
                                             struct isostudy_mesh *mesh);

/*
 Extracts the surface between samples in a box of cells. `window` is that of `isostudy_chunks_window`, or a larger box. The samples are those of its
 corners, x fastest, then y: one more than cells along each axis. Methods with samples elsewhere than at corners are an error, as a
 wrong `count` is.

 # Safety
 `chunks` came from `isostudy_chunks_new`, and no other thread uses it. `samples` leads to `count` numbers. `mesh` leads to room for the answer.
 */
enum isostudy_status isostudy_chunks_extract_samples(struct isostudy_chunks *chunks,
                                                     struct isostudy_cells window,
                                                     const float *samples,
                                                     size_t count,
                                                     struct isostudy_cells cells,
                                                     struct isostudy_mesh *mesh);

/*
 Which chunks of so many cells a side can change when values change in the box from `min` to `max`, three numbers each, and nowhere else.
 Writes up to `capacity` of their ids, three numbers each, and to `count` how many there are.

 # Safety
 `chunks` came from `isostudy_chunks_new`, and no other thread uses it. `ids` is null with a `capacity` of 0, or leads to room for
 so many ids. The other pointers lead to what the text says.
 */
enum isostudy_status isostudy_chunks_touched(struct isostudy_chunks *chunks,
                                             const float *min,
                                             const float *max,
                                             uint32_t cells_per_side,
                                             int32_t *ids,
                                             size_t capacity,
                                             size_t *count);

/*
 Makes an object for chunks of all levels, as `isostudy_chunks_new` does for one. The grid is that of level 0, the finest; each further level has
 cells twice as large.

 # Safety
 Each pointer is null, which is an error, or leads to what the text says.
 */
enum isostudy_status isostudy_levels_new(const char *method_name,
                                         const double *origin,
                                         double spacing,
                                         float isovalue,
                                         uint32_t normals,
                                         struct isostudy_levels **levels);

/*
 Frees the object with its buffers. Null is nothing.

 # Safety
 `levels` is null or came from `isostudy_levels_new`, and is not used afterwards.
 */
void isostudy_levels_free(struct isostudy_levels *levels);

/*
 Extracts the surface of a field in a box of cells of a level, with the seams to its neighbours. `around` has the levels of what touches the
 chunk: 27 numbers, x fastest, for the directions from (-1, -1, -1) to (1, 1, 1). The one in the middle does not matter.

 # Safety
 `levels` came from `isostudy_levels_new`, and no other thread uses it. `field` leads to functions that keep their promises. `around` leads to 27
 numbers, and `mesh` to room for the answer.
 */
enum isostudy_status isostudy_levels_extract(struct isostudy_levels *levels,
                                             const struct isostudy_field *field,
                                             uint32_t level,
                                             struct isostudy_cells cells,
                                             const uint32_t *around,
                                             struct isostudy_mesh *mesh);

/*
 What went wrong in the last call of this thread that did not return `ISOSTUDY_STATUS_OK`, in UTF-8. The text is valid until the next call of this
 thread. It is empty before the first one.
 */
const char *isostudy_last_error(void);

/*
 The version of the library, as in `0.1.0`.
 */
const char *isostudy_version(void);

/*
 Makes an object for whole volumes. It is written to `volume`, and freed by `isostudy_volume_free`.

 # Safety
 `volume` is null, which is an error, or leads to room for a pointer.
 */
enum isostudy_status isostudy_volume_new(struct isostudy_volume **volume);

/*
 Frees the object with its mesh. Null is nothing.

 # Safety
 `volume` is null or came from `isostudy_volume_new`, and is not used afterwards.
 */
void isostudy_volume_free(struct isostudy_volume *volume);

/*
 Extracts the surface in a volume of samples by a method such as `"mc33"`. `threads` is 0 for all cores.

 # Safety
 `volume` came from `isostudy_volume_new`, and no other thread uses it. `samples` leads to a description whose `values` are as many as the product
 of its counts. `method_name` leads to text that ends with a zero, and `mesh` to room for the answer.
 */
enum isostudy_status isostudy_volume_extract(struct isostudy_volume *volume,
                                             const char *method_name,
                                             const struct isostudy_samples *samples,
                                             float isovalue,
                                             size_t threads,
                                             struct isostudy_mesh *mesh);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* ISOSTUDY_H */
