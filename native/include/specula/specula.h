/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Specula: path tracing with Specular Manifold Sampling. The whole public interface, C99.
 *
 * Conventions
 *   Space      right-handed, Z up, as in Blender. World space is metres.
 *   Transforms row-major 3x4, float[12]: world = M * (x, y, z, 1).
 *   Colour     linear Rec.709 primaries, float[3] or float[4].
 *   Images     rows from the bottom up, left to right (Blender's order).
 *   Numbers    finite. Coordinates and extents, in a mesh's own space and in the world, are at most
 *              1e8 m, and so are the entries of a transform and of its inverse. All that has no
 *              unit of length (colours, strengths, powers, texels, normals, UV) is at most 1e15.
 *              What exceeds that is refused with SPC_INVALID_ARGUMENT; what overflows in a render
 *              is counted in spc_render_stats.
 *   Text       UTF-8, zero-terminated. Names are only used in messages; they need not be unique.
 *   Structs    `struct_size` comes first and must be sizeof the struct as compiled by the caller; a
 *              library that does not know that size refuses it with SPC_INVALID_ARGUMENT.
 *   Ownership  everything passed in is copied before the call returns. Handles are freed by their
 *              own destroy function; destroying NULL does nothing.
 *   Errors     every function that can fail returns an spc_status, or NULL where it returns a text.
 *              On failure nothing has changed, and spc_last_error() says what was wrong, naming the
 *              object. Any call may fail with SPC_INVALID_ARGUMENT, SPC_OUT_OF_MEMORY or
 *              SPC_INTERNAL_ERROR; the comments name what else it may return. No exception crosses
 *              this boundary. A call that runs out of memory says for what; everything but a scene
 *              whose commit failed so is as usable as before.
 *   Threads    a scene may be used by one thread at a time until it is committed, also while a
 *              thread of the library commits it; afterwards all but its camera is immutable, and it
 *              may feed any number of sessions. A session may be polled, read and cancelled from
 *              any thread.
 *
 * Order of calls: create, add images, then materials, meshes, lights and instances (an index can
 * only refer to what was added before), set camera and environment, commit, start renders.
 * spc_scene_edit() begins a scene that differs little from another.
 */
#ifndef SPECULA_SPECULA_H
#define SPECULA_SPECULA_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define SPC_API __attribute__((visibility("default")))
#else
#define SPC_API
#endif

/* This number is raised whenever a struct or the meaning of a call changes. */
#define SPC_API_VERSION 18u

/* This value stands for "no index" where an index is optional. */
#define SPC_NONE 0xffffffffu

typedef struct spc_scene spc_scene;
typedef struct spc_session spc_session;

typedef enum spc_status {
    SPC_OK = 0,
    /* null pointer, bad struct_size, index or number out of range, not finite */
    SPC_INVALID_ARGUMENT = 1,
    SPC_WRONG_STATE = 2, /* a call out of order: adding after commit, rendering before it */
    SPC_OUT_OF_MEMORY = 3,
    SPC_IO_ERROR = 4,       /* a file could not be read */
    SPC_UNSUPPORTED = 5,    /* reserved: no call returns it */
    SPC_INTERNAL_ERROR = 6, /* a bug in Specula */
    SPC_CANCELLED = 7       /* spc_scene_commit_cancel() has ended what was waited for */
} spc_status;

/* Returns SPC_API_VERSION of the library that was loaded. Callers compare it with the version that
 * they were compiled with. */
SPC_API uint32_t spc_api_version(void);
/* Returns version, instruction level and Embree's version: "0.1.0 x86-64-v3 Embree 3.13.5". The
 * text is static. */
SPC_API const char* spc_version_string(void);
/* Returns the message of the calling thread's last failed call, or "" if none has failed. The
 * library owns the text, which is valid until the thread's next failed call. */
SPC_API const char* spc_last_error(void);

/* ---------------------------------------------------------------------------------------- scene */

/* Creates an empty scene, which the caller destroys. */
SPC_API spc_status spc_scene_create(spc_scene** scene);
/* Frees a scene. All of its sessions must have been destroyed before. */
SPC_API void spc_scene_destroy(spc_scene* scene);

/* Creates a scene that shares with `before`, which was made by this call and is committed, what it
 * keeps of it by the calls below and what follows from that: trees over geometry, tables of the
 * world and of glints. Its pictures are those of a scene by this call, without `before`, into which
 * all has been added anew, to the bit but for surfaces that coincide; one by spc_scene_create() has
 * copies of small meshes in one tree, and rounds otherwise. Here each instance has a tree of its
 * own, which takes a little longer to render and makes the next scene cheap. `before` may be NULL,
 * for the first of a series, and be destroyed at any time. Embree's threads are those of the first
 * commit. The scene keeps its light sheets while its camera moves. Errors: SPC_WRONG_STATE
 * (`before` is not committed). */
SPC_API spc_status spc_scene_edit(const spc_scene* before, spc_scene** scene);

/* Adds what the scene before has at an index, as the calls that add do, but shares it. A material
 * needs the images that it reads kept before it, with their indices. Errors: SPC_WRONG_STATE (there
 * is no scene before). */
SPC_API spc_status spc_scene_keep_image(spc_scene* scene, uint32_t before, uint32_t* image_index);
SPC_API spc_status spc_scene_keep_material(spc_scene* scene, uint32_t before,
                                           uint32_t* material_index);
SPC_API spc_status spc_scene_keep_mesh(spc_scene* scene, uint32_t before, uint32_t* mesh_index);

/* ---- images */

typedef enum spc_pixel_type {
    SPC_PIXEL_U8 = 0, /* uint8_t[height][width][channels] */
    SPC_PIXEL_F32 = 1 /* float[height][width][channels], finite */
} spc_pixel_type;

typedef enum spc_color_space {
    SPC_COLOR_LINEAR = 0, /* linear Rec.709: nothing to convert */
    SPC_COLOR_SRGB = 1,   /* sRGB transfer function on the colour channels, not on alpha */
    /* not a colour (normal maps, masks): nothing to convert, alpha not associated */
    SPC_COLOR_DATA = 2
} spc_color_space;

typedef enum spc_alpha_mode {
    SPC_ALPHA_STRAIGHT = 0,      /* the colour is not multiplied by alpha yet */
    SPC_ALPHA_PREMULTIPLIED = 1, /* the colour is multiplied by alpha already */
    SPC_ALPHA_NONE = 2,          /* alpha is read as 1 */
    SPC_ALPHA_PACKED = 3         /* alpha is a fourth value with no bearing on the colour */
} spc_alpha_mode;

/* An image has exactly one source: `pixels` (with width, height, channels and pixel_type),
 * `encoded` (the bytes of an image file) or `path`. Files may have any format that OpenImageIO
 * reads. A library that is built without OpenImageIO, such as that of the addon's package, refuses
 * them with SPC_IO_ERROR. */
typedef struct spc_image_desc {
    size_t struct_size;
    const char* name;
    const void* pixels;     /* bottom row first, or NULL */
    uint32_t width, height; /* pixels, >= 1; only with `pixels` */
    uint32_t channels;      /* 1, 3 or 4; only with `pixels` */
    uint32_t pixel_type;    /* spc_pixel_type; only with `pixels` */
    const void* encoded;    /* bytes of a file, or NULL */
    size_t encoded_size;    /* bytes, > 0; only with `encoded` */
    const char* path;       /* a file, or NULL */
    uint32_t color_space;   /* spc_color_space */
    uint32_t alpha_mode;    /* spc_alpha_mode */
} spc_image_desc;

/* Adds an image and gives its index. Errors: SPC_IO_ERROR (unreadable or not an image),
 * SPC_WRONG_STATE (after commit). */
SPC_API spc_status spc_scene_add_image(spc_scene* scene, const spc_image_desc* desc,
                                       uint32_t* image_index);

/* ---- materials
 *
 * A material is a graph of typed nodes. docs/nodes.md lists their kinds, sockets and options, and
 * so does spc_node_kinds() at run time. `node`, `from_node` and `to_node` are indices into
 * spc_material_desc.nodes. */

typedef struct spc_node {
    const char* name; /* as the artist sees it; for messages */
    const char* kind; /* "bsdf_diffuse", "mix_shader", "image_texture", ... */
    uint32_t image;   /* index of an image for kinds that read one, else SPC_NONE */
} spc_node;

/* The constant of an input socket. A link to the socket takes precedence. A socket that has neither
 * constant nor link has Blender's default. */
typedef struct spc_node_input {
    uint32_t node;
    const char* socket;
    float value[4]; /* scalar sockets read value[0], vectors and colours value[0..2]; finite */
} spc_node_input;

/* A choice or a name that belongs to a node: "distribution" = "GGX", "uv_map" = "UVMap". A choice
 * that is not given is the first one of its option, a name that is not given is empty. */
typedef struct spc_node_option {
    uint32_t node;
    const char* option;
    const char* value;
} spc_node_option;

/* Numbers that a node looks up, such as the colours of a ramp. They are finite and stand row by
 * row: as many in a row as the kind says, in at least two rows. A node that is used must be given
 * its kind's arrays. */
typedef struct spc_node_array {
    uint32_t node;
    const char* name;
    const float* values; /* float[count] */
    uint32_t count;      /* of all numbers, not of rows */
} spc_node_array;

/* An output feeds an input. An input has at most one link; a shader may feed shader inputs
 * alone. */
typedef struct spc_node_link {
    uint32_t from_node;
    const char* from_socket;
    uint32_t to_node;
    const char* to_socket;
} spc_node_link;

/* Which narrow lobes on a normal map or bump are averaged over the footprint of each pixel in the
 * map's image. AUTO: those of constant roughness up to 0.4. ON: all that can be; the scene's report
 * says why a material has none. OFF: none. */
typedef enum spc_glints { SPC_GLINTS_AUTO = 0, SPC_GLINTS_ON = 1, SPC_GLINTS_OFF = 2 } spc_glints;

/* What the output's socket "Displacement" does, which is in metres of the world. BUMP: it turns
 * normals, as a bump of the surface. VERTICES: it moves vertices, when the scene is committed and
 * once for each mesh with the same materials, as the first such instance stands. BOTH: vertices,
 * and the normals of the surface as it was. */
typedef enum spc_displacement {
    SPC_DISPLACEMENT_BUMP = 0,
    SPC_DISPLACEMENT_VERTICES = 1,
    SPC_DISPLACEMENT_BOTH = 2
} spc_displacement;

/* What is done where shading normals disagree with the surface: with reflections that would go
 * below it, and at the edge between light and shadow. NONE: nothing. SMOOTHED: as in Cycles of
 * Blender 3.4. MICROFACET: as in that of 5.0. */
typedef enum spc_bump_correction {
    SPC_BUMP_CORRECTION_NONE = 0,
    SPC_BUMP_CORRECTION_SMOOTHED = 1,
    SPC_BUMP_CORRECTION_MICROFACET = 2
} spc_bump_correction;

/* Exactly one node has kind "output". Its socket "Surface" is the surface, or the background of a
 * world. Its socket "Volume" is the medium behind front faces, which absorbs if all kinds of rays
 * see the instance. A graph may contain unused nodes; cycles are refused. */
typedef struct spc_material_desc {
    size_t struct_size;
    const char* name;
    const spc_node* nodes;
    uint32_t node_count;
    const spc_node_input* inputs;
    uint32_t input_count;
    const spc_node_option* options;
    uint32_t option_count;
    const spc_node_array* arrays;
    uint32_t array_count;
    const spc_node_link* links;
    uint32_t link_count;
    uint32_t glints;          /* spc_glints; a world ignores it */
    uint32_t bump_correction; /* spc_bump_correction; likewise */
    uint32_t displacement;    /* spc_displacement; likewise */
    uint32_t pass_index;      /* what SPC_PASS_MATERIAL_INDEX shows */
    float crypto;             /* identifier for Cryptomatte; 0: none */
} spc_material_desc;

/* Compiles a material and gives its index. Errors: SPC_WRONG_STATE (after commit). */
SPC_API spc_status spc_scene_add_material(spc_scene* scene, const spc_material_desc* desc,
                                          uint32_t* material_index);

/* What an attribute is. A material finds those of a mesh by name or, where it gives no name, by
 * their kind; those of an object, which are the same all over it, by kind and name. */
typedef enum spc_attribute_kind {
    SPC_ATTRIBUTE_NAMED = 0,
    SPC_ATTRIBUTE_UV = 1,         /* the active UV layer */
    SPC_ATTRIBUTE_COLOR = 2,      /* the active colour */
    SPC_ATTRIBUTE_GENERATED = 3,  /* the place in the undeformed mesh's box, 0 to 1 */
    SPC_ATTRIBUTE_POINTINESS = 4, /* how convex the mesh is, as Cycles has it */
    SPC_ATTRIBUTE_ISLAND = 5,     /* a random number for each connected part */
    /* Of objects from here. */
    SPC_ATTRIBUTE_OBJECT = 6,        /* a property of the object */
    SPC_ATTRIBUTE_INSTANCER = 7,     /* a property of what makes the instance */
    SPC_ATTRIBUTE_OBJECT_INFO = 8,   /* an output of Blender's node of that name */
    SPC_ATTRIBUTE_PARTICLE_INFO = 9, /* likewise */
    SPC_ATTRIBUTE_VIEW_LAYER = 10    /* a property of the view layer */
} spc_attribute_kind;

/* An attribute that a material reads. */
typedef struct spc_attribute_need {
    const char* name;  /* "": the one of its kind */
    uint32_t kind;     /* spc_attribute_kind */
    uint32_t tangents; /* 1: the tangents of a UV layer, too */
} spc_attribute_need;

/* What surfaces of a material read from their mesh and their object. The scene owns the array and
 * its texts. */
typedef struct spc_material_needs {
    size_t struct_size;
    const spc_attribute_need* attributes; /* valid until the next call for this scene */
    uint32_t attribute_count;
} spc_material_needs;

/* Says, before commit, what a mesh with this material must bring. Errors: SPC_WRONG_STATE (after
 * commit). */
SPC_API spc_status spc_scene_material_needs(spc_scene* scene, uint32_t material_index,
                                            spc_material_needs* needs);

/* Says, before commit, what a material emits: `mean` (float[3]) is its emission with the means of
 * what varies over a surface, and `varies` is 1 if anything does. Errors: SPC_WRONG_STATE (after
 * commit). */
SPC_API spc_status spc_scene_material_emission(spc_scene* scene, uint32_t material_index,
                                               float* mean, uint32_t* varies);

/* Lists the kinds of nodes, one in a line: `kind: in Socket:type ... out Socket:type ... option
 * name=A|B ... array name:COLUMNS ...`. The text is static. */
SPC_API const char* spc_node_kinds(void);

/* ---- geometry */

/* What an attribute has a value for. */
typedef enum spc_attribute_domain {
    SPC_DOMAIN_CORNER = 0, /* triangle_count * 3 elements */
    SPC_DOMAIN_VERTEX = 1, /* vertex_count */
    SPC_DOMAIN_TRIANGLE = 2,
    SPC_DOMAIN_OBJECT = 3 /* one; the only domain of an instance's attributes, and theirs alone */
} spc_attribute_domain;

/* Numbers for materials to read, interpolated over triangles. One component stands for all of a
 * colour, two are x and y, a fourth is alpha. */
typedef struct spc_attribute {
    const char* name;
    uint32_t kind;       /* spc_attribute_kind */
    uint32_t domain;     /* spc_attribute_domain */
    uint32_t components; /* 1 to 4 */
    const float* values; /* float[elements][components] */
    /* of a UV layer (two components at corners): float[triangle_count][3][4], MikkTSpace tangent
     * xyz in object space and bitangent sign; or NULL */
    const float* tangents;
} spc_attribute;

typedef struct spc_mesh_desc {
    size_t struct_size;
    const char* name;
    const float* positions; /* float[vertex_count][3], object space, finite */
    uint32_t vertex_count;
    /* uint32_t[triangle_count][3], each < vertex_count, counter-clockwise outside */
    const uint32_t* triangles;
    uint32_t triangle_count;
    const float* normals; /* float[triangle_count][3][3] of corners, object space; NULL = flat */
    /* uint32_t[triangle_count]: not 0 for triangles that stay flat however their vertices are
     * displaced; NULL: none, but all without normals */
    const uint32_t* flat_faces;
    const uint32_t* material_slots; /* uint32_t[triangle_count], each < slot_count; NULL = slot 0 */
    uint32_t slot_count;            /* >= 1 */
    const spc_attribute* attributes;
    uint32_t attribute_count;
} spc_mesh_desc;

/* Adds a triangle mesh and gives the index by which instances refer to it. Triangles of zero area
 * are dropped and counted in spc_scene_stats.dropped_triangles. A mesh of nothing else is accepted
 * and draws nothing; one without triangles is refused. Corner normals are normalised; one of zero
 * length takes the face's normal. Errors: SPC_WRONG_STATE (after commit). */
SPC_API spc_status spc_scene_add_mesh(spc_scene* scene, const spc_mesh_desc* desc,
                                      uint32_t* mesh_index);

/* Bits: the kinds of rays that see an object, as in Blender's ray visibility. */
typedef enum spc_visibility {
    SPC_VISIBLE_CAMERA = 1,
    SPC_VISIBLE_DIFFUSE = 2,
    SPC_VISIBLE_GLOSSY = 4,
    SPC_VISIBLE_TRANSMISSION = 8,
    SPC_VISIBLE_SHADOW = 16,
    SPC_VISIBLE_ALL = 31
} spc_visibility;

/* An object's part in caustics. AUTO: it casts where one of its materials has a specular closure,
 * or a narrow one that is not weak (roughness up to 0.4; docs/nodes.md), and receives where one has
 * a closure that is not specular. The others rule out what they do not name. */
typedef enum spc_caustics_role {
    SPC_CAUSTICS_AUTO = 0,
    SPC_CAUSTICS_OFF = 1,
    SPC_CAUSTICS_CASTER = 2,
    SPC_CAUSTICS_RECEIVER = 3,
    SPC_CAUSTICS_BOTH = 4
} spc_caustics_role;

typedef struct spc_instance_desc {
    size_t struct_size;
    const char* name;
    uint32_t mesh;
    float transform[12];       /* object to world; invertible; may mirror and scale unevenly */
    const uint32_t* materials; /* uint32_t[material_count]; SPC_NONE = nothing is drawn there */
    uint32_t material_count;   /* must equal the mesh's slot_count */
    uint32_t visibility;       /* of spc_visibility */
    uint32_t caustics_role;    /* spc_caustics_role */
    float terminator_offset; /* 0 .. 1: how far the edge of light on smooth normals moves into the light */
    uint32_t holdout;        /* 1: the camera sees a hole of alpha 0 in its place */
    uint32_t pass_index;               /* what SPC_PASS_OBJECT_INDEX shows */
    float crypto_object, crypto_asset; /* identifiers for Cryptomatte; 0: none */
    const char* light_group;           /* of the light that it emits; NULL or "": none */
    const spc_attribute* attributes;
    uint32_t attribute_count;
    uint64_t receives_in, blocks_in;      /* sets that it is in, a bit each: see spc_light_desc */
    uint64_t receiver_sets, blocker_sets; /* of the light that it emits: see spc_light_desc */
} spc_instance_desc;

/* Places a mesh in the world and gives the instance's index. Errors: SPC_WRONG_STATE (after
 * commit). */
SPC_API spc_status spc_scene_add_instance(spc_scene* scene, const spc_instance_desc* desc,
                                          uint32_t* instance_index);

/* Who looks for the caustics that an object casts, where the method has them. */
typedef enum spc_caustics_search {
    SPC_SEARCH_NONE = 0, /* it casts none */
    SPC_SEARCH_LIGHT_PATHS = 1,
    SPC_SEARCH_MANIFOLD = 2, /* and light paths */
    /* light paths, and the manifold if the normal map turns out to be coarse */
    SPC_SEARCH_MANIFOLD_IF_COARSE = 3
} spc_caustics_search;

/* The part that an object would take in caustics. The scene owns the texts, which are valid until
 * the next call for it. */
typedef struct spc_forecast {
    size_t struct_size;
    uint32_t receives; /* 1: shows caustics */
    uint32_t search;   /* spc_caustics_search */
    /* a closure by which it casts, or why it does not; "" if its role rules casting out */
    const char* reason;
    const char* glints;    /* closures that glint; "" if there are none */
    const char* no_glints; /* why there are none where a material asks for them, else "" */
} spc_forecast;

/* Says, before commit, which part an object of these materials would take. The object need not be
 * in the scene, and nothing is built. `materials` are `material_count` >= 1 indices; `visibility`
 * and `caustics_role` are as in spc_instance_desc. Errors: SPC_WRONG_STATE (after commit). */
SPC_API spc_status spc_scene_forecast(spc_scene* scene, const uint32_t* materials,
                                      uint32_t material_count, uint32_t visibility,
                                      uint32_t caustics_role, spc_forecast* forecast);

/* ---- lights */

typedef enum spc_light_type {
    SPC_LIGHT_POINT = 0, /* sphere of `radius`; a point if that is 0 */
    SPC_LIGHT_SPOT = 1,  /* the same, shining along -Z within a cone */
    SPC_LIGHT_SUN = 2,   /* from infinity along -Z */
    SPC_LIGHT_AREA = 3   /* rectangle or ellipse in XY, shining along -Z from one side */
} spc_light_type;

typedef enum spc_area_shape { SPC_AREA_RECTANGLE = 0, SPC_AREA_ELLIPSE = 1 } spc_area_shape;

typedef struct spc_light_desc {
    size_t struct_size;
    const char* name;
    uint32_t type;       /* spc_light_type */
    float transform[12]; /* light to world; scale matters only to area lights */
    /* Blender's power times colour, W; sun: irradiance at normal incidence, W/m^2; >= 0 */
    float power[3];
    float radius;        /* point, spot: m, >= 0 */
    float spot_angle;    /* spot: full opening angle, rad, (0, pi] */
    float spot_blend;    /* spot: share of the cone that is soft, [0, 1] */
    float sun_angle;     /* sun: full angular diameter, rad, [0, pi] */
    uint32_t shape;      /* area: spc_area_shape */
    float size[2];       /* area: full extents in x and y before the transform, m, > 0 */
    float spread;        /* area: full angle of the beam, rad, [0, pi]; pi: the half-space */
    uint32_t visibility; /* of spc_visibility; SHADOW set: occluders cast shadows of this light */
    /* 0: walks, light sheets and light paths ignore it; its caustics are left to path tracing */
    uint32_t feeds_caustics;
    uint32_t soft_falloff; /* point, spot; 1: a disk that faces what it lights, not a sphere */
    /* Material whose emission is a factor of the light by point and direction, or SPC_NONE: as it
     * is. Object space is the light's; a sun is seen at the unit vector along its light. */
    uint32_t material;
    const char* light_group; /* NULL or "": none */
    /* Sets, a bit each, whose members alone it shines on, and whose members alone throw its shadow;
     * 0: everything. It shines on where its light scatters first, and what shadows it stands before
     * that. Light paths do not start at a light with blockers. */
    uint64_t receiver_sets, blocker_sets;
    /* Surfaces behind more bounces than this are not connected to it; their rays still find it, with
     * the weight that they have beside connections. */
    uint32_t max_bounces;
} spc_light_desc;

/* Adds a light and gives its index. Errors: SPC_WRONG_STATE (after commit). */
SPC_API spc_status spc_scene_add_light(spc_scene* scene, const spc_light_desc* desc,
                                       uint32_t* light_index);

/* ---- camera and world */

typedef enum spc_projection {
    SPC_PROJECTION_PERSPECTIVE = 0,
    SPC_PROJECTION_ORTHOGRAPHIC = 1, /* parallel rays from the plane through the camera */
    /* Panoramic, with the numbers that `panorama` holds; angles in rad. */
    SPC_PROJECTION_EQUIRECTANGULAR = 2, /* least and largest longitude, least and largest latitude */
    SPC_PROJECTION_FISHEYE_EQUIDISTANT = 3, /* field of view */
    /* field of view, focal length > 0, width and height of the sensor in its unit */
    SPC_PROJECTION_FISHEYE_EQUISOLID = 4,
    /* field of view, k0 to k4 of the angle -(k0 + k1 r + k2 r^2 + ...), width and height of the
     * sensor in the unit of r */
    SPC_PROJECTION_FISHEYE_POLYNOMIAL = 5,
    SPC_PROJECTION_MIRROR_BALL = 6,              /* none */
    SPC_PROJECTION_EQUIANGULAR_CUBEMAP_FACE = 7, /* none */
    /* least and largest longitude, least and largest height on a cylinder of radius 1 */
    SPC_PROJECTION_CENTRAL_CYLINDRICAL = 8
} spc_projection;

typedef struct spc_camera_desc {
    size_t struct_size;
    uint32_t projection;    /* spc_projection */
    float transform[12];    /* camera to world; looks along -Z, +Y is up; scale is ignored */
    uint32_t width, height; /* pixels of the full frame, >= 1 */
    /* x0, y0, width, height of the rendered part, pixels from the bottom left, within the full
     * frame */
    uint32_t crop[4];
    /* left, right, bottom, top of the full frame: perspective, on the plane at distance 1;
     * orthographic, in m; panoramic, in shares of the whole panorama, which 0, 1, 0, 1 is */
    float viewplane[4];
    float panorama[8];         /* as the projection says */
    float clip_near, clip_far; /* along the viewing axis or a panorama's ray, m; 0 <= near < far */
    /* Depth of field: a thin lens. */
    float aperture_radius; /* m, >= 0; 0: all is in focus, and nothing below is read */
    float focus_distance;  /* along the viewing axis or a panorama's ray, m, > 0 */
    /* sides of the aperture, a regular polygon with its corners on the radius: >= 3; 0: a disc */
    uint32_t aperture_blades;
    float aperture_rotation; /* of the polygon, rad, from +X to +Y; 0: a side's middle is at +X */
    float aperture_ratio;    /* height by width, > 0: the width is divided by it */
} spc_camera_desc;

/* Sets the camera. After spc_scene_commit, too: the next render looks from there, and nothing is
 * built again. Errors: SPC_WRONG_STATE (a session of the scene has not been destroyed yet). */
SPC_API spc_status spc_scene_set_camera(spc_scene* scene, const spc_camera_desc* desc);

/* The world's background. Without it the world is black. */
typedef struct spc_environment_desc {
    size_t struct_size;
    uint32_t material;       /* index of a material whose surface is a background */
    uint32_t visibility;     /* of spc_visibility; SHADOW is ignored */
    uint32_t feeds_caustics; /* as in spc_light_desc; of a world only bright, narrow parts do */
    const char* light_group; /* NULL or "": none */
} spc_environment_desc;
/* Sets the world, in place of one that was set before. Errors: SPC_WRONG_STATE (after commit). */
SPC_API spc_status spc_scene_set_environment(spc_scene* scene, const spc_environment_desc* desc);

/* ---- commit */

/* Builds everything that rendering needs, then freezes the scene. `threads` is at most 1024; 0: one
 * for each processor. Errors: SPC_WRONG_STATE (no camera, or committed before). */
SPC_API spc_status spc_scene_commit(spc_scene* scene, uint32_t threads);

/* Begins that on a thread of the library and returns at once. Until the call below tells the end,
 * the scene can only be waited for, cancelled, and destroyed, which cancels it and waits: all else
 * fails with SPC_WRONG_STATE. Errors: SPC_WRONG_STATE, as above. */
SPC_API spc_status spc_scene_commit_start(spc_scene* scene, uint32_t threads);
/* Waits until that ends or `milliseconds` have passed, and tells in `ended` whether it has, once:
 * then the scene is committed, or the error that has ended it is returned, SPC_CANCELLED among
 * them, and the scene is lost. Errors: SPC_WRONG_STATE (it was not started, or its end was told).
 */
SPC_API spc_status spc_scene_commit_wait(spc_scene* scene, uint32_t milliseconds, uint32_t* ended);
/* Asks it to stop, and returns at once. It stops soon, but for tables of lights and of glints,
 * which are made to the end. Errors: SPC_WRONG_STATE, as for the wait. */
SPC_API spc_status spc_scene_commit_cancel(spc_scene* scene);

typedef struct spc_scene_stats {
    size_t struct_size;
    uint64_t triangles; /* of meshes, however many instances each has */
    uint64_t instances;
    uint64_t lights;            /* lights, emissive instances and the world together */
    uint64_t casters;           /* instances that cast sharp or blurred caustics */
    uint64_t receivers;         /* instances */
    uint64_t dropped_triangles; /* of zero area */
    /* of geometry, images and what is known of their slopes; without Embree's trees */
    uint64_t memory_bytes;
    double commit_seconds; /* that its commit took */
} spc_scene_stats;
/* Errors: SPC_WRONG_STATE (not committed). */
SPC_API spc_status spc_scene_get_stats(const spc_scene* scene, spc_scene_stats* stats);

/* Returns lines for the log, after commit: one for each caster, which says what it is taken for and
 * why, and one for each thing that the scene asks for and that falls back to another. The scene
 * owns the text, which lives as long as it. NULL if the scene is not committed. */
SPC_API const char* spc_scene_report(const spc_scene* scene);

/* --------------------------------------------------------------------------------------- render */

typedef enum spc_method {
    SPC_METHOD_PT = 0,           /* path tracing alone */
    SPC_METHOD_SMS_UNBIASED = 1, /* [Zeltner20, Alg. 2] */
    /* [Zeltner20, Alg. 3]: loses the solutions that `set_size` walks miss */
    SPC_METHOD_SMS_BIASED = 2,
    SPC_METHOD_LT = 3,     /* path tracing and light tracing, no manifold */
    SPC_METHOD_SHEETS = 4, /* manifold: all chains by light sheets, walks for what they miss */
    /* [Hanika15]: at most one refraction and one reflection, from MNEE seeds. What they miss is
     * path traced, or lost by SPC_METHOD_MNEE_BIASED. Lights without extent have no paths to
     * trace. */
    SPC_METHOD_MNEE = 5,
    SPC_METHOD_MNEE_BIASED = 6,
    /* the best that there is for the scene: as SHEETS, but casters that make more chains at once
     * than a search is worth are left to light paths and path tracing; spc_render_report() says
     * which */
    SPC_METHOD_AUTO = 7
} spc_method;

/* Whether methods with manifold sampling trace light paths, too, and look for camera chains, to the
 * lights that the camera sees in casters. The session chooses how many light paths.
 * SPC_METHOD_SHEETS has camera chains in any case. AUTO does what ON does, for now. */
typedef enum spc_light_tracing {
    SPC_LIGHT_TRACING_AUTO = 0,
    SPC_LIGHT_TRACING_ON = 1,
    SPC_LIGHT_TRACING_OFF = 2
} spc_light_tracing;

/* What is zero at a solution of a walk [Zeltner20]: the angle between the generalised half-vector
 * and the normal, or the one between the scattered and the wanted direction. The picture is the
 * same, the noise differs. */
typedef enum spc_constraint {
    SPC_CONSTRAINT_HALF_VECTOR = 0,
    SPC_CONSTRAINT_ANGLE_DIFFERENCE = 1
} spc_constraint;

/* How glints are averaged over a pixel's footprint in a normal map or bump. SEARCH is the one to
 * use; the others are there to compare with. */
typedef enum spc_glint_method {
    SPC_GLINT_METHOD_SEARCH = 0,
    SPC_GLINT_METHOD_WALKS = 1, /* [Zeltner20, Sec. 4.5], with a random number of trials */
    /* the same with `set_size` walks: loses the light that they miss */
    SPC_GLINT_METHOD_WALKS_BIASED = 2,
    /* [Yan16]: biased; Gaussians stand for map, pixel and lobe, and take memory for each session */
    SPC_GLINT_METHOD_YAN = 3
} spc_glint_method;

typedef enum spc_pixel_filter {
    SPC_FILTER_BOX = 0,
    SPC_FILTER_GAUSSIAN = 1,
    SPC_FILTER_BLACKMAN_HARRIS = 2
} spc_pixel_filter;

/* What Cryptomatte tells apart. */
typedef enum spc_crypto {
    SPC_CRYPTO_OBJECT = 0,
    SPC_CRYPTO_MATERIAL = 1,
    SPC_CRYPTO_ASSET = 2
} spc_crypto;

typedef struct spc_render_settings {
    size_t struct_size;
    uint32_t method;        /* spc_method */
    uint32_t light_tracing; /* spc_light_tracing; ignored by PT and LT */
    uint32_t constraint;    /* spc_constraint */
    uint32_t two_stage; /* 1: walk on the smooth surface first where a caster has a normal map */
    /* walks per estimate of SPC_METHOD_SMS_BIASED and SPC_GLINT_METHOD_WALKS_BIASED, [1, 4096] */
    uint32_t set_size;
    uint32_t glint_method; /* spc_glint_method */
    uint32_t first_sample; /* absolute index; [0,8) and [8,16) together are [0,16): to the bit
                              * for SPC_METHOD_PT, in the mean for methods that learn as they go */
    uint32_t samples;      /* per pixel, >= 1 */
    /* Of the render that this one is a part of, or 0. What parts learn depends on this number
     * alone, so that they add up to the same picture, to the bit, however its samples are divided
     * among them. At least first_sample + samples; a part has no time limit. */
    uint32_t total_samples;
    float time_limit; /* seconds of rendering, 0 = none; a render that reaches it is complete */
    uint32_t seed;
    uint32_t threads;     /* 0 = all, <= 1024 */
    uint32_t max_bounces; /* all kinds together; as Cycles: 0 is direct light only */
    uint32_t max_diffuse_bounces, max_glossy_bounces, max_transmission_bounces,
        max_transparent_bounces;
    uint32_t caustics_reflective,
        caustics_refractive;   /* 0: no such light after a diffuse bounce, by any method */
    uint32_t pixel_filter;     /* spc_pixel_filter */
    float filter_width;        /* pixels, full width; [0.01, 1000]; ignored by the box */
    uint32_t transparent_film; /* 1: the world is seen as alpha 0 by the camera */
    /* 1: also through glass, of at most this roughness, [0, 1] */
    uint32_t transparent_glass;
    float transparent_glass_roughness;
    /* The only chains that walks look for, from the receiver on, at most 6: "TT" are two
     * refractions, "R" is one reflection; the rest is path tracing's. NULL or empty: all. Ignored
     * by other methods. */
    const char* chain_family;
    /* sum of 1 << spc_pass: what is kept beside Combined, Variance and Sample Count, which always
     * are */
    uint64_t passes;
    /* Names of spc_custom_pass, a line each, at most 256 and all different; NULL or empty: none.
     * AOVs are what nodes `aov_output` of that name write. */
    const char* light_groups;
    const char* color_aovs;
    const char* value_aovs;
    /* An AOV adds up what the surfaces that the camera sees write, up to the first whose alpha is
     * at least so large, [0, 1]. */
    float pass_alpha_threshold;
    /* Of SPC_PASS_MIST: a power of the distance from the camera beyond `mist_start` over
     * `mist_depth`, m, >= 0. */
    float mist_start, mist_depth, mist_exponent;
    /* 1: errors of neighbouring pixels are independent, at the price of some noise */
    uint32_t for_denoiser;
    uint32_t crypto_kinds; /* sum of 1 << spc_crypto: what Cryptomatte is kept of */
    uint32_t crypto_ranks; /* identifiers that a pixel shows of each, [0, 16] */
    /* Pixels whose error is below it take no more samples; 0: all take all of them. Light paths do
     * in any case. Parts ignore it. */
    float noise_threshold;
    uint32_t min_samples; /* of each pixel before that; 0: by the threshold, as in Cycles */
} spc_render_settings;

/* Fills in the defaults, struct_size included: SPC_METHOD_AUTO with light tracing, 64 samples, no
 * time limit, seed 0, a thread for each processor, and limits of bounces and filter as in a new
 * file of Blender's Cycles. */
SPC_API void spc_render_settings_init(spc_render_settings* settings);

/* Starts worker threads, returns at once and gives a session, which the caller destroys. The scene
 * must outlive it. Errors: SPC_WRONG_STATE (the scene is not committed). */
SPC_API spc_status spc_render_start(const spc_scene* scene, const spc_render_settings* settings,
                                    spc_session** session);

typedef enum spc_render_state {
    SPC_RENDER_RUNNING = 0,
    SPC_RENDER_DONE = 1, /* all samples, or the time limit */
    SPC_RENDER_CANCELLED = 2,
    SPC_RENDER_FAILED = 3 /* spc_render_wait() returns the error, and spc_last_error() says why */
} spc_render_state;

/* What a render does, in this order. All before SAMPLES is its preparation: if there is a time
 * limit, each of these stages takes at most a part of it. Meanwhile SPC_PASS_COMBINED shows a
 * coarse preview. */
typedef enum spc_render_stage {
    SPC_STAGE_MAPS = 0,          /* normal maps of glints, and which casters are searched */
    SPC_STAGE_SHEETS = 1,        /* light sheets */
    SPC_STAGE_LIGHT_PATHS = 2,   /* a pilot of light paths */
    SPC_STAGE_CAMERA_CHAINS = 3, /* lights that the camera sees in casters */
    SPC_STAGE_PROBES = 4,        /* noise and work of some pixels */
    SPC_STAGE_SAMPLES = 5,
    SPC_STAGE_COUNT = 6
} spc_render_stage;

typedef struct spc_render_progress {
    size_t struct_size;
    uint32_t state;        /* spc_render_state */
    uint32_t samples_done; /* complete for every pixel */
    float fraction;        /* of samples or of the time limit, whichever is larger, [0, 1] */
    double seconds;        /* of rendering so far */
    uint32_t stage;        /* spc_render_stage */
    float stage_fraction;  /* of what the stage may take, [0, 1] */
    double seconds_left;   /* an estimate; negative while there is none */
} spc_render_progress;

/* Waits until the render ends or `milliseconds` have passed, and fills in `progress`, which may be
 * NULL. If the render has failed, it returns the error that ended it, and `progress` is filled in
 * as well. */
SPC_API spc_status spc_render_wait(spc_session* session, uint32_t milliseconds,
                                   spc_render_progress* progress);
/* Asks the workers to stop and returns at once; they stop within 200 ms. Samples already taken are
 * kept. */
SPC_API spc_status spc_render_cancel(spc_session* session);
/* Holds a render back that is taking samples once each pixel has as many, or lets it go on
 * (`paused` 0). Its preparation is not held back, nor is its time limit. */
SPC_API spc_status spc_render_pause(spc_session* session, uint32_t paused);

typedef struct spc_render_stats {
    size_t struct_size;
    uint64_t samples;   /* camera paths */
    uint64_t rays;      /* ray casts, shadow rays and walks included */
    uint64_t estimates; /* manifold estimates begun */
    uint64_t walks;     /* Newton walks, trials included */
    uint64_t walks_converged;
    uint64_t iterations;      /* Newton iterations of all walks */
    uint64_t trial_estimates; /* estimates that ran Bernoulli trials */
    uint64_t trials;          /* sum over those estimates */
    uint64_t max_trials;
    uint64_t trial_histogram[17]; /* of those estimates: [2^i, 2^(i+1)) trials in bin i */
    uint64_t capped_estimates;    /* gave up at the trial cap */
    /* what those estimates added, with the trials that they had counted; luminance, sum over
     * samples */
    double capped_energy;
    double manifold_energy; /* radiance added by the manifold, luminance, sum over samples */
    uint64_t nan_samples;   /* samples and splats dropped for not being finite, or above 1e18 */
    uint64_t light_paths;   /* from lights; those that learned where to start included */
    uint64_t splats;        /* that light paths added to the picture */
    /* Of light sheets and camera chains: chain seeds that were shot, different chains that they
     * found, and chains that only searches found, with the luminance that these added, sum over
     * samples. */
    uint64_t chain_seeds, seeded_chains, missed_chains;
    double missed_energy;
    uint64_t glint_estimates; /* of the light of one direction, over a footprint */
    uint64_t glint_nodes;     /* parts of maps that they looked at, or slopes on walks */
    uint64_t glint_points;    /* points of those, or Gaussians, at which they evaluated a lobe */
    uint64_t glint_capped; /* estimates of SPC_GLINT_METHOD_WALKS that gave up at the trial cap */
    uint64_t glint_bytes;  /* of memory that the method has for such maps, beside the images */
    /* of each spc_render_stage that has ended, 0 of others; their sum is the time of the whole
     * render */
    double stage_seconds[6];
    double first_sample_seconds; /* from the start until every pixel had a sample; 0 until then */
    /* that were not cast since they were not finite; by all sessions of the scene since this one's
     * start */
    uint64_t lost_rays;
} spc_render_stats;
/* Fills in what the render has done so far, or in all if it has ended. */
SPC_API spc_status spc_render_get_stats(spc_session* session, spc_render_stats* stats);

/* Returns what the method has chosen, one line for each caster about which it had a choice, with
 * the numbers that decided. The text is complete once SPC_STAGE_SAMPLES has begun; it is
 * valid until the calling thread calls this function again. NULL on failure. */
SPC_API const char* spc_render_report(spc_session* session);

/* The pictures that a render gives. Comments begin with the number of channels. */
typedef enum spc_pass {
    SPC_PASS_COMBINED = 0, /* 4: RGBA, premultiplied */
    SPC_PASS_DEPTH = 1,    /* 1: distance along the viewing axis, m; 1e10 where nothing is hit */
    SPC_PASS_POSITION = 2, /* 3: world, m; of the first sample, and so is depth */
    SPC_PASS_NORMAL = 3,   /* 3: world, shading normal, mean over the samples */
    SPC_PASS_CAUSTICS = 4, /* 3: the manifold's and light tracing's share of Combined */
    /* 3: variance of the mean of Combined's RGB; light paths splat on several pixels, so that
     * errors of neighbours are correlated */
    SPC_PASS_VARIANCE = 5,
    /* What manifold sampling had to do for a pixel [Zeltner20]; 0 where it did nothing. */
    SPC_PASS_WALK_SUCCESS = 6, /* 1: share of the Newton walks that converged, trials included */
    SPC_PASS_WALK_TRIALS = 7,  /* 1: mean number of Bernoulli trials of estimates that made some */
    /* 3: on the mesh's active layer, of the first sample; the third is 1 where there is one */
    SPC_PASS_UV = 8,
    SPC_PASS_MIST = 9,            /* 1: of the first surface; 1 where nothing is hit */
    SPC_PASS_OBJECT_INDEX = 10,   /* 1: of the first sample */
    SPC_PASS_MATERIAL_INDEX = 11, /* 1: of the first sample */
    /* Light by the first scattering on its way from the camera; caustics are indirect. Combined is
     * the sum of Emission, Environment, and for each kind of scattering its colour times the sum of
     * direct and indirect. */
    SPC_PASS_EMISSION = 12,    /* 3: of lamps and surfaces that the camera sees straight */
    SPC_PASS_ENVIRONMENT = 13, /* 3 */
    SPC_PASS_DIFFUSE_DIRECT = 14,
    SPC_PASS_GLOSSY_DIRECT = 15,
    SPC_PASS_TRANSMISSION_DIRECT = 16,
    SPC_PASS_DIFFUSE_INDIRECT = 17,
    SPC_PASS_GLOSSY_INDIRECT = 18,
    SPC_PASS_TRANSMISSION_INDIRECT = 19,
    SPC_PASS_DIFFUSE_COLOR = 20,
    SPC_PASS_GLOSSY_COLOR = 21,
    SPC_PASS_TRANSMISSION_COLOR = 22,
    /* Of the first surface that is no mirror and no clear glass, seen through those. */
    SPC_PASS_DENOISING_ALBEDO = 23, /* 3 */
    SPC_PASS_DENOISING_NORMAL = 24, /* 3: camera space; +Z leads away from the camera */
    SPC_PASS_DENOISING_DEPTH = 25,  /* 1: m, along the path, from the near clip on */
    SPC_PASS_SAMPLE_COUNT = 26,     /* 1 */
    SPC_PASS_COUNT = 27
} spc_pass;

/* The first passes of those that spc_render_settings names: the others of a kind follow. */
typedef enum spc_custom_pass {
    SPC_CUSTOM_LIGHT_GROUP = 256, /* 3: light of the group's lights; Combined has it, too */
    SPC_CUSTOM_COLOR_AOV = 512,   /* 4: alpha counts the surfaces that wrote it */
    SPC_CUSTOM_VALUE_AOV = 768    /* 1 */
} spc_custom_pass;

/* Returns how many floats a pixel of the pass has; 0 for an unknown pass. */
SPC_API uint32_t spc_pass_channels(uint32_t pass);

/* Returns one line for each pass, in their order: its channels, a letter each, a space, and its
 * name in Blender 5. The text is static. */
SPC_API const char* spc_passes(void);

/* Copies a pass of the crop as it stands: float[crop height][crop width][channels], bottom row
 * first. `count` is the number of floats that `buffer` holds and must be exact. Where a pixel has
 * no sample yet, the preview stands in Combined as soon as there is one; other passes have 0 there,
 * but for what light paths splat. Errors: SPC_INVALID_ARGUMENT (a pass that was not asked for,
 * too). */
SPC_API spc_status spc_film_read(spc_session* session, uint32_t pass, float* buffer, size_t count);

/* Copies two ranks of Cryptomatte, those from 2 * `level` on, of one spc_crypto: float[crop
 * height][crop width][4], bottom row first: identifier, share of the pixel, identifier, share; the
 * largest shares first. `count` as in spc_film_read. Errors: SPC_INVALID_ARGUMENT (it was not asked
 * for). */
SPC_API spc_status spc_film_read_crypto(spc_session* session, uint32_t kind, uint32_t level,
                                        float* buffer, size_t count);

/* ---- sums: what a render has accumulated, to divide its samples among processes, to keep them,
 * and to go on. Sums of parts (spc_render_settings.total_samples) add up to those of one render, to
 * the bit. They are bytes of this machine's order, for this version of the library alone; the
 * caller knows of which scene and samples they are. */

typedef struct spc_sums {
    size_t struct_size;
    const void* data; /* owned by the session; valid until this thread exports it again */
    size_t size;
    uint32_t samples; /* of every pixel, from spc_render_settings.first_sample on */
} spc_sums;

/* Gives the sums so far, at any time: the render stands still until all pixels have the same
 * samples. Errors: SPC_WRONG_STATE (it has ended before that: cancelled, or out of time),
 * SPC_OUT_OF_MEMORY. */
SPC_API spc_status spc_film_export(spc_session* session, spc_sums* sums);

/* Adds the sums of other samples of the same picture in their place. `earlier`: 1 if those are of
 * samples before these. Errors: SPC_INVALID_ARGUMENT (no sums, or of another picture). */
SPC_API spc_status spc_sums_add(void* sums, const void* other, size_t size, uint32_t earlier);

/* The width and height that sums have. */
SPC_API spc_status spc_sums_extent(const void* sums, size_t size, uint32_t extent[2]);

/* As spc_film_read. */
SPC_API spc_status spc_sums_read(const void* sums, size_t size, uint32_t pass, float* buffer,
                                 size_t count);

/* As spc_film_read_crypto. */
SPC_API spc_status spc_sums_read_crypto(const void* sums, size_t size, uint32_t kind,
                                        uint32_t level, float* buffer, size_t count);

/* Cancels the render if it has not ended, waits for its workers, and frees the session. */
SPC_API void spc_session_destroy(spc_session* session);

#ifdef __cplusplus
}
#endif
#endif
