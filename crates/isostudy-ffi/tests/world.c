/* A world in C: a ball in two levels of detail, a hole that is dug, chunks from samples, and a whole volume.
 * Ends with 0 if all meshes are what they must be, else with the line of the check that failed. */
#include "isostudy.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHECK(holds)                                                                                     \
    do {                                                                                                 \
        if (!(holds)) {                                                                                  \
            fprintf(stderr, "%s:%d: %s\n%s\n", __FILE__, __LINE__, #holds, isostudy_last_error());       \
            exit(1);                                                                                     \
        }                                                                                                \
    } while (0)
#define OK(call) CHECK((call) == ISOSTUDY_STATUS_OK)

static const double PI = 3.14159265358979323846;

/* A ball with a hole. */
typedef struct {
    float radius, hole_x, hole_radius;
    long calls;
} ball_t;

static float ball(void *user, float x, float y, float z)
{
    ball_t *of = user;
    of->calls++;
    float solid = of->radius - sqrtf(x * x + y * y + z * z);
    if (of->hole_radius <= 0)
        return solid;
    float dx = x - of->hole_x;
    float hole = of->hole_radius - sqrtf(dx * dx + y * y + z * z);
    return fminf(solid, -hole);
}

/* By the nearest and the farthest point of the box. The hole only lowers values, and by no more than its radius below 0. */
static bool ball_range(void *user, const float *min, const float *max, float *least, float *greatest)
{
    const ball_t *of = user;
    float near = 0, far = 0;
    for (int axis = 0; axis < 3; axis++) {
        float low = min[axis] > 0 ? min[axis] : max[axis] < 0 ? -max[axis] : 0;
        near += low * low;
        far += fmaxf(min[axis] * min[axis], max[axis] * max[axis]);
    }
    *least = fminf(of->radius - sqrtf(far), -of->hole_radius) - 1e-4f;
    *greatest = of->radius - sqrtf(near) + 1e-4f;
    return true;
}

/* A directed edge by the bits of its ends, the smaller end first. */
typedef struct {
    float ends[6];
    int way;
} edge_t;

static edge_t *edges;
static size_t edge_count, edge_room;
static double volume_6;

static void add(const isostudy_mesh *mesh)
{
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        float p[3][3];
        for (int corner = 0; corner < 3; corner++) {
            size_t v = mesh->triangles[3 * t + corner];
            CHECK(v < mesh->vertex_count);
            memcpy(p[corner], mesh->positions + 3 * v, sizeof p[corner]);
        }
        volume_6 += p[0][0] * ((double)p[1][1] * p[2][2] - (double)p[1][2] * p[2][1]) +
                    p[0][1] * ((double)p[1][2] * p[2][0] - (double)p[1][0] * p[2][2]) +
                    p[0][2] * ((double)p[1][0] * p[2][1] - (double)p[1][1] * p[2][0]);
        for (int corner = 0; corner < 3; corner++) {
            if (edge_count == edge_room) {
                edge_room = edge_room ? 2 * edge_room : 1024;
                edges = realloc(edges, edge_room * sizeof *edges);
                CHECK(edges);
            }
            edge_t *edge = &edges[edge_count++];
            const float *from = p[corner], *to = p[(corner + 1) % 3];
            edge->way = memcmp(from, to, sizeof p[0]) < 0 ? 1 : -1;
            memcpy(edge->ends, edge->way > 0 ? from : to, sizeof p[0]);
            memcpy(edge->ends + 3, edge->way > 0 ? to : from, sizeof p[0]);
        }
    }
}

static int by_ends(const void *one, const void *other)
{
    return memcmp(((const edge_t *)one)->ends, ((const edge_t *)other)->ends, 6 * sizeof(float));
}

/* How many edges are not run as often in one direction as in the other. */
static size_t open_edges(void)
{
    qsort(edges, edge_count, sizeof *edges, by_ends);
    size_t open = 0;
    for (size_t i = 0, j; i < edge_count; i = j) {
        int sum = 0;
        for (j = i; j < edge_count && by_ends(&edges[i], &edges[j]) == 0; j++)
            sum += edges[j].way;
        open += sum != 0;
    }
    edge_count = 0;
    return open;
}

static isostudy_cells chunk(int x, int y, int z, int side)
{
    isostudy_cells cells = {{x * side, y * side, z * side}, {(x + 1) * side, (y + 1) * side, (z + 1) * side}};
    return cells;
}

/* East of the middle chunks of level 0 with 16 cells a side, west of it of level 1 with 8. */
static void levels_are_closed(const double *origin, ball_t *of)
{
    isostudy_field field = {ball, ball_range, of};
    isostudy_levels *levels = NULL;
    OK(isostudy_levels_new("mc", origin, 0.25, 0.0f, ISOSTUDY_NORMALS_TRIANGLES, &levels));
    size_t seams = 0;
    volume_6 = 0;
    for (int corner = 0; corner < 8; corner++) {
        int x = (corner & 1) - 1, y = (corner >> 1 & 1) - 1, z = (corner >> 2) - 1;
        uint32_t level = x < 0, around[27];
        for (int i = 0; i < 27; i++)
            around[i] = x + i % 3 - 1 < 0;
        isostudy_mesh mesh;
        OK(isostudy_levels_extract(levels, &field, level, chunk(x, y, z, 16 >> level), around, &mesh));
        CHECK(mesh.triangle_count > 100 && mesh.normals);
        seams += mesh.seam_count;
        add(&mesh);
    }
    CHECK(seams > 50);
    CHECK(open_edges() == 0);
    double expected = 4 / 3.0 * PI * (pow(of->radius, 3) - pow(of->hole_radius, 3));
    CHECK(fabs(volume_6 / 6 - expected) < 0.02 * expected);
    isostudy_levels_free(levels);
}

/* A hole changes the chunks that are named, and no other. */
static void holes_change_what_is_touched(const double *origin, ball_t *of)
{
    isostudy_field field = {ball, NULL, of};
    isostudy_chunks *chunks = NULL;
    OK(isostudy_chunks_new("mc33", origin, 0.25, 0.0f, ISOSTUDY_NORMALS_TRIANGLES, &chunks));
    OK(isostudy_chunks_reserve(chunks, 4000));
    /* Values change farther than the hole reaches: as far as it is nearer than the ball's own surface. */
    float min[3] = {-3.2f, -3.2f, -3.2f}, max[3] = {3.2f, 3.2f, 3.2f};
    int32_t ids[64][3];
    size_t count = 0;
    OK(isostudy_chunks_touched(chunks, min, max, 16, NULL, 0, &count));
    CHECK(count == 8);
    OK(isostudy_chunks_touched(chunks, min, max, 16, &ids[0][0], 64, &count));
    CHECK(count == 8 && ids[0][0] == -1 && ids[7][0] == 0 && ids[7][2] == 0);
    double volume[2];
    for (int dug = 0; dug < 2; dug++) {
        of->hole_radius = dug ? 1.0f : 0.0f;
        volume_6 = 0;
        for (size_t i = 0; i < count; i++) {
            isostudy_mesh mesh;
            OK(isostudy_chunks_extract(chunks, &field, chunk(ids[i][0], ids[i][1], ids[i][2], 16), &mesh));
            CHECK(mesh.origin[0] == ids[i][0] * 4.0);
            add(&mesh);
        }
        CHECK(open_edges() == 0);
        volume[dug] = volume_6 / 6;
    }
    /* Four cells to its radius: chords lose a few percent. */
    CHECK(fabs(volume[0] - volume[1] - 4 / 3.0 * PI) < 0.05 * 4 / 3.0 * PI);
    isostudy_chunks_free(chunks);
}

/* Samples of a chunk's window make the chunk that the field makes, to the bit. */
static void samples_are_as_good(const double *origin, ball_t *of)
{
    isostudy_field field = {ball, NULL, of};
    isostudy_chunks *chunks = NULL;
    OK(isostudy_chunks_new("nets", origin, 0.25, 0.0f, ISOSTUDY_NORMALS_TRIANGLES, &chunks));
    isostudy_cells cells = chunk(0, -1, 0, 16), window;
    OK(isostudy_chunks_window(chunks, cells, &window));
    size_t count = 1, place = 0;
    for (int axis = 0; axis < 3; axis++)
        count *= (size_t)(window.end[axis] - window.start[axis] + 1);
    float *samples = malloc(count * sizeof *samples);
    CHECK(samples);
    for (int z = window.start[2]; z <= window.end[2]; z++)
        for (int y = window.start[1]; y <= window.end[1]; y++)
            for (int x = window.start[0]; x <= window.end[0]; x++)
                samples[place++] = ball(of, 0.25f * x, 0.25f * y, 0.25f * z);
    isostudy_mesh mesh;
    long calls[2];
    for (int ranged = 0; ranged < 2; ranged++) {
        calls[ranged] = of->calls;
        field.range = ranged ? ball_range : NULL;
        OK(isostudy_chunks_extract(chunks, &field, cells, &mesh));
        calls[ranged] = of->calls - calls[ranged];
    }
    CHECK(calls[1] < calls[0]);
    size_t vertices = mesh.vertex_count, triangles = mesh.triangle_count;
    CHECK(triangles > 300);
    float *positions = malloc(3 * vertices * sizeof *positions);
    CHECK(positions);
    memcpy(positions, mesh.positions, 3 * vertices * sizeof *positions);
    OK(isostudy_chunks_extract_samples(chunks, window, samples, count, cells, &mesh));
    CHECK(mesh.vertex_count == vertices && mesh.triangle_count == triangles);
    CHECK(memcmp(positions, mesh.positions, 3 * vertices * sizeof *positions) == 0);
    CHECK(isostudy_chunks_extract_samples(chunks, window, samples, count - 1, cells, &mesh) ==
          ISOSTUDY_STATUS_EXTRACT);
    CHECK(strstr(isostudy_last_error(), "samples"));
    isostudy_chunks_free(chunks);

    /* Normals by samples: the same chunk, less of a window, and away from the ball's centre. */
    OK(isostudy_chunks_new("nets", origin, 0.25, 0.0f, ISOSTUDY_NORMALS_SAMPLES, &chunks));
    CHECK(isostudy_chunks_extract(chunks, &field, cells, &mesh) == ISOSTUDY_STATUS_EXTRACT);
    CHECK(strstr(isostudy_last_error(), "samples"));
    OK(isostudy_chunks_extract_samples(chunks, window, samples, count, cells, &mesh));
    CHECK(mesh.vertex_count == vertices && mesh.triangle_count == triangles && mesh.normals);
    CHECK(memcmp(positions, mesh.positions, 3 * vertices * sizeof *positions) == 0);
    size_t of_ball = 0;
    for (size_t v = 0; v < vertices; v++) {
        const float *p = mesh.positions + 3 * v, *n = mesh.normals + 3 * v;
        float length = sqrtf(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        if (fabsf(length - of->radius) > 0.1f || fabsf(p[0]) < 2 * of->hole_radius)
            continue;
        CHECK((n[0] * p[0] + n[1] * p[1] + n[2] * p[2]) / length > 0.98f);
        of_ball++;
    }
    CHECK(of_ball > 100);
    free(positions);
    free(samples);
    isostudy_chunks_free(chunks);
}

/* Every sample of a volume, by a method of samples and by one that calls the samples' interpolant. */
static void volumes_are_closed(ball_t *of)
{
    enum { N = 31 };
    static float samples[N * N * N];
    for (int i = 0; i < N * N * N; i++)
        samples[i] = ball(of, 0.25f * (i % N - 15), 0.25f * (i / N % N - 15), 0.125f * (i / N / N - 15));
    isostudy_samples volume_of = {samples, {N, N, N}, {-3.75, -3.75, -1.875}, {0.25, 0.25, 0.125}};
    of->radius = 1.5f;
    for (int i = 0; i < N * N * N; i++)
        samples[i] = ball(of, 0.25f * (i % N - 15), 0.25f * (i / N % N - 15), 0.125f * (i / N / N - 15));
    isostudy_volume *volume = NULL;
    OK(isostudy_volume_new(&volume));
    const char *methods[] = {"mc33", "bi", "dc-in-cell"};
    for (int m = 0; m < 3; m++) {
        isostudy_mesh mesh;
        OK(isostudy_volume_extract(volume, methods[m], &volume_of, 0.0f, 2, &mesh));
        volume_6 = 0;
        add(&mesh);
        CHECK(open_edges() == 0);
        CHECK(fabs(volume_6 / 6 - 4 / 3.0 * PI * pow(1.5, 3)) < 0.6);
    }
    isostudy_volume_free(volume);
}

static void mistakes_are_said(const double *origin)
{
    isostudy_chunks *chunks = NULL;
    CHECK(isostudy_chunks_new("mc34", origin, 1, 0, 1, &chunks) == ISOSTUDY_STATUS_ARGUMENT);
    CHECK(strstr(isostudy_last_error(), "mc34") && strstr(isostudy_last_error(), "mc33"));
    CHECK(isostudy_chunks_new("mc", origin, 1, 0, 4, &chunks) == ISOSTUDY_STATUS_ARGUMENT);
    CHECK(isostudy_chunks_new("mc", NULL, 1, 0, 1, &chunks) == ISOSTUDY_STATUS_ARGUMENT);
    CHECK(isostudy_chunks_new("mc", origin, 0, 0, 1, &chunks) == ISOSTUDY_STATUS_EXTRACT);
    CHECK(strstr(isostudy_last_error(), "spacing"));
    CHECK(chunks == NULL);
    OK(isostudy_chunks_new("mc", origin, 1, 0, 1, &chunks));
    isostudy_mesh mesh;
    isostudy_field nothing = {NULL, NULL, NULL};
    isostudy_cells none = {{0, 0, 0}, {0, 1, 1}};
    CHECK(isostudy_chunks_extract(chunks, &nothing, none, &mesh) == ISOSTUDY_STATUS_ARGUMENT);
    CHECK(isostudy_chunks_extract(NULL, &nothing, none, &mesh) == ISOSTUDY_STATUS_ARGUMENT);
    CHECK(isostudy_chunks_window(chunks, none, &none) == ISOSTUDY_STATUS_EXTRACT);
    isostudy_chunks_free(chunks);
    isostudy_chunks_free(NULL);
    CHECK(strcmp(isostudy_version(), "0.1.0") == 0);
}

int main(void)
{
    const double origin[3] = {0, 0, 0};
    ball_t of = {3.1f, 0.5f, 1.0f, 0};
    levels_are_closed(origin, &of);
    holes_change_what_is_touched(origin, &of);
    samples_are_as_good(origin, &of);
    of.hole_radius = 0;
    volumes_are_closed(&of);
    mistakes_are_said(origin);
    free(edges);
    printf("a world in C: %ld calls of the field\n", of.calls);
    return 0;
}
