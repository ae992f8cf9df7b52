#include <core/scene/explanations.hpp>

#include <algorithm>

namespace rt::scene {
namespace {

constexpr Explanation kExplanations[] = {
    // ---- exit 2: usage
    {Code{201}, "a movie file on its own",
     R"(A movie file moves the objects of a scene file, by their numbers, and means nothing
without it. Convert the scene that names it, or name it beside the scene:

    rt convert Scene.inf
    rt convert Scene.inf --movie Movie.inf)"},

    // ---- exit 3: the scene
    {Code{301}, "unknown key",
     R"(A map has a key that the scene language does not have at this place, most often a
misspelt one. Nothing is ignored in silence: a key that did nothing would be a picture
that is not what the scene says. `rt plugins TYPE` lists the keys of an object or
texture, scenes/LANGUAGE.md all others.)"},
    {Code{302}, "missing key",
     R"(A map lacks a key that has no default. The message stands at the map's own key.)"},
    {Code{303}, "wrong kind of value",
     R"(A list stands where a number is wanted, a number where a map is wanted, and so on.
Text in quotes is text: "1.5" is no number. A key without a value has none, and is not 0.)"},
    {Code{304}, "not a number",
     R"(Numbers are written in decimal, as 12, -0.5, .5 or 1e-3. There are no octal or
hexadecimal numbers, no '_' between digits, no decimal comma, and no leading zeros: 010
means 8 to some programs and 10 to others.)"},
    {Code{305}, "not finite",
     R"(Every number of a scene is finite: .nan, .inf and numbers beyond 1e308 are none that a
picture could be computed from.)"},
    {Code{306}, "out of range",
     R"(The number is outside of what its key allows; the message says the limits. Lengths and
coordinates lie between -1e18 and 1e18 everywhere.)"},
    {Code{307}, "not a whole number",
     R"(The key counts something and takes 3, but neither 3.5 nor 3.0 nor 3e0.)"},
    {Code{308}, "not an angle",
     R"(Angles are written with their unit, since half of all programs mean degrees and the
others radians:

    field_of_view: 45deg
    rotate: {axis: [0, 0, 1], angle: 0.785rad})"},
    {Code{309}, "not a colour",
     R"(A colour is one number for grey, three numbers for red, green and blue, both of them
linear light, or a text of the form "#rrggbb", which is sRGB as in web pages and is
turned into linear light. The quotes are needed: '#' starts a comment.

    color: 0.5
    color: [1, 0.5, 0]
    color: "#ff8000")"},
    {Code{310}, "none of the choices",
     R"(The key takes one of a few words, which the message lists.)"},
    {Code{311}, "not true or false",
     R"(The key takes true or false. yes, no, on, off, 1 and 0 are not accepted.)"},
    {Code{312}, "wrong number of entries",
     R"(A point, direction or colour has three numbers: [x, y, z] or [r, g, b].)"},
    {Code{313}, "name taken",
     R"(Two objects, or two lights, have the same name. Tracks could not tell them apart.)"},
    {Code{314}, "not a name",
     R"(Names may hold letters of any script, digits, blanks and most signs, but no '.' and no
'=', which separate the parts of paths such as moon.radius or --set moon.radius=2.
The names of sections (camera, lights, ...) are no names for objects.)"},
    {Code{315}, "unknown material",
     R"(An object names a material that the section 'materials' does not have.)"},
    {Code{316}, "unknown texture",
     R"(The section 'textures' does not have a texture of this name.)"},
    {Code{317}, "unknown type",
     R"(There is no shape, texture, loader or light of this type, but one with a similar name.
`rt plugins` lists those that are installed.)"},
    {Code{318}, "scale 0",
     R"(A scale of 0 flattens an object to nothing, and cannot be undone for the rays that meet
it. Keyframes that lead from a positive scale to a negative one pass 0 on the way.)"},
    {Code{319}, "no direction",
     R"(A direction or axis is [0, 0, 0]; or the camera looks along its own 'up', so that no
side of the picture would be up.)"},
    {Code{320}, "empty box",
     R"(The corner 'max' of the box must be above 'min' on all three axes.)"},
    {Code{321}, "keys that exclude each other",
     R"(Two keys of a map say the same thing in two ways, such as 'forward' and 'look_at' or
'screen' and 'field_of_view', or a key has no meaning beside what another key says.
Remove one of them.)"},
    {Code{322}, "version of the language",
     R"(A scene starts with the version of the language that it is written in: 'rt: 1'. This
program does not know the version that the scene states; a newer program does.)"},
    {Code{323}, "path not allowed",
     R"(A scene may say where its picture goes only below the current folder, so that nobody's
scene can overwrite anything else: relative, without '..'. The option -o names any place.
Paths have at most 4095 bytes and no NUL.)"},
    {Code{324}, "no loader for a file",
     R"(The suffix of the file's name does not say which loader reads it. Name one:

    - mesh: {file: bunny.dat, loader: openmesh})"},
    {Code{325}, "one type to a map",
     R"(Items of 'objects' and 'lights', and each texture, are a map of one key, the type,
whose value has all other keys:

    objects:
      - sphere: {name: moon, radius: 4}
      - sphere:
          name: sun
          radius: 9

In the second form the keys stand further to the right than the type.)"},
    {Code{326}, "range that does not rise",
     R"(A range [first, last] of frames must rise; of faces, it must not fall. A film of N images
has the frames 0 to N - 1.)"},
    {Code{327}, "unknown target",
     R"(The target of a track is no object of the scene, no point of the camera
(camera.position, camera.front, camera.top), and, for keyframes, no number of the scene.
Paths of numbers are written as

    moon.radius   lights.key.color   materials.steel.diffuse   camera.screen.width)"},
    {Code{328}, "motion that does not fit its target",
     R"(A point of the camera has no axis of its own to turn about, and a background only fades.)"},
    {Code{329}, "keyframes that do not fit",
     R"(A number that counts something has no values between two keyframes: give it
'interpolation: step'.)"},
    {Code{330}, "tracks that contradict each other",
     R"(Two fades of the background overlap, or two tracks have keyframes for the same number.)"},
    {Code{331}, "--set that cannot be applied",
     R"(--set takes a path into the scene and a value, as it would stand in the file:

    --set render.depth=3
    --set moon.radius=2.5
    --set 'camera.position=[0, 0, 5]'

Objects and lights go by their name, or by their number, counted from 0.)"},
    {Code{340}, "camera without a direction",
     R"(In one of the images the moved camera has its front point where it stands, or looks along
its own up direction.)"},
    {Code{341}, "face that the mesh does not have",
     R"(A track moves faces of a mesh beyond its last one. Faces are counted from 0 in the order
of the file.)"},
    {Code{348}, "value that a plugin refuses",
     R"(The value is within its limits, but the plugin cannot use it together with the others.
Its message says why.)"},
    {Code{349}, "textures that need each other",
     R"(A texture names another one that leads back to it.)"},

    // ---- exit 3: YAML
    {Code{350}, "not YAML",
     R"(The text is no YAML at this place. Most often the indentation of a line does not fit the
lines above, a text with ': ' or a special first sign needs quotes, or a quote above is
closed too early.)"},
    {Code{351}, "key twice in a map",
     R"(Each key may stand once in a map. YAML programs disagree on which of two counts.)"},
    {Code{352}, "quote or bracket not closed",
     R"(A quote, '[' or '{' is not closed where it must be.)"},
    {Code{353}, "tab as indentation",
     R"(YAML is indented with blanks only. Most editors can turn tabs into blanks.)"},
    {Code{354}, "second document",
     R"(A scene is one YAML document. '---' or '...' starts another one, as does a line that is
indented less than the first line.)"},
    {Code{355}, "not UTF-8 text", R"(Scenes are text in UTF-8, without control characters.)"},
    {Code{356}, "empty file",
     R"(The file has nothing in it but blanks and comments. A scene starts with 'rt: 1'.)"},
    {Code{357}, "unknown anchor",
     R"(An alias *name repeats what an anchor &name stands before; there is no such anchor above.)"},
    {Code{358}, "alias inside its own anchor",
     R"(The alias stands within the very node that it repeats, which would have no end.)"},
    {Code{359}, "not a key", R"(Keys are words. A list, a map or nothing cannot be a key.)"},
    {Code{360}, "merge of something else",
     R"('<<' copies the keys of another map into this one, or of several: '<<: *base' or
'<<: [*base, *more]'. Keys that the map has itself come first.)"},
    {Code{361}, "tag",
     R"(Tags such as !!float or !Sphere are a part of YAML that scenes do not use.)"},

    // ---- exit 3: .inf files
    {Code{380}, "unknown keyword of an .inf or movie file",
     R"(A statement starts with a word that the old program did not know. It skipped the word
and tried its numbers as keywords; --lenient does the same, and notes it.)"},
    {Code{381}, "not a number in an .inf or movie file",
     R"(A statement has something else where its next number must stand.)"},
    {Code{382}, "not a whole number in an .inf or movie file",
     R"(A count or an index has a fraction.)"},
    {Code{383}, "statement that is not complete",
     R"(A statement of an .inf or movie file has too few numbers. The old program took what the
statement before had left, or what lay in memory; --lenient follows it where it can.)"},
    {Code{384}, "number of an .inf or movie file out of range",
     R"(The number cannot mean anything; the message says what it may be.)"},
    {Code{385}, "mode of an obj",
     R"(The mode of an 'obj' statement is one of normal, obj and object.)"},
    {Code{386}, "word too long",
     R"(A word of an .inf file is longer than the old program could read.)"},
    {Code{387}, "point of the camera",
     R"(A movie file moves the points v (eye), f (front) and u (top) of the camera.)"},
    {Code{388}, "motion of a movie file",
     R"(The motions are rotate, rotateSelf, move, moveRadius and moveDirect; a point of the camera
has no rotateSelf.)"},
    {Code{389}, "object number of a movie file",
     R"(A movie file names objects by number, from 0, in the order of the scene file; each face of
a mesh counts as one object.)"},
    {Code{390}, "statement missing from an .inf or movie file",
     R"(A scene needs the statements window, scene and camera; a movie file its movie line.)"},
    {Code{391}, "texture number",
     R"(Textures go by their number in the order of their statements, from 0.)"},
    {Code{392}, "object number behind a mesh that cannot be read",
     R"(Each face of a mesh counts as one object of a movie file, so that the numbers behind it are
known only when the mesh can be read.)"},
    {Code{393}, "refractivity",
     R"(An object that lets light through needs an index of refraction above 0.)"},
    {Code{394}, "camera of an .inf file",
     R"(The camera's forward and upward must be two different directions.)"},
    {Code{395}, "fades that overlap",
     R"(A movie file fades the background to one texture at a time.)"},

    // ---- exit 4: files
    {Code{401}, "no such file",
     R"(The file does not exist. Paths in a scene start at the folder of the scene file.)"},
    {Code{402}, "file that cannot be read",
     R"(The file exists, but may not be read, or reading it failed.)"},
    {Code{403}, "not a regular file",
     R"(Only regular files are read: no folders, pipes, sockets or devices.)"},
    {Code{404}, "file outside of the sandbox",
     R"(With --sandbox only files that really lie in the scene's folder, or in one of --allow-read,
are read, whatever links and '..' lead there.)"},
    {Code{405}, "not a viewer script",
     R"(rt view --script reads one command a line; a # starts a comment:

    key NAME [COUNT]      a character, or: space esc left right up down
    click X Y             press and release at a pixel
    drag X0 Y0 X1 Y1      press, move, release
    wheel STEPS X Y       positive: away from you
    wait                  until the picture is final
    pause MILLISECONDS)"},
    {Code{406}, "no folder of frames",
     R"(`rt encode` takes the folder NAME.frames that `rt render` fills with the frames of a
film, and the manifest in it that says which of them are complete. For frames that were
rendered to numbered files it takes the same pattern, such as frame_%04d.png.)"},
    {Code{407}, "frames are missing",
     R"(A film is encoded from all of its frames, or from those that --frames names. A frame is
missing if the manifest does not have it, and broken if its file is not as long as the
manifest says or has another checksum. `rt render ... --resume` renders exactly these.)"},
    {Code{408}, "no job directory",
     R"(`rt farm` and `rt task` take the directory that `rt farm submit` has made, NAME.job by
default. It lies on a disk that all nodes share.)"},
    {Code{409}, "no sandbox here",
     R"(--sandbox has the kernel hold plugins to the readable folders (Landlock, Linux 5.13 and newer).
This kernel cannot, so nothing was read.)"},
    {Code{410}, "not an .inf or movie file", R"(The file is no text.)"},
    {Code{420}, "mesh file that cannot be used",
     R"(The loader of the file cannot make geometry of it; its message says where and why.)"},
    {Code{450}, "picture that cannot be used",
     R"(The file is no picture of a known format, which is told from its first bytes and not from
its name: PNG, JPEG, BMP, HDR, EXR, PFM, PPM.)"},
    {Code{451}, "damaged picture", R"(The picture ends early or contradicts itself.)"},
    {Code{452}, "picture with values that are not finite",
     R"(A pixel of the picture is infinite or no number.)"},

    // ---- exit 5: plugins
    {Code{501}, "plugin that is needed and cannot be had",
     R"(The message quotes the reason. `rt plugins` shows the search path and what it holds.)"},
    {Code{520}, "no such plugin",
     R"(The scene names a type that no plugin offers, or whose plugin was refused; the message
quotes the reason. Plugins are files NAME.rtplugin.so in the folders of --plugin-dir, of
RT_PLUGIN_PATH, and beside the program; never in the folder of the scene. `rt plugins`
shows the search path and what it holds.)"},
    {Code{521}, "plugin with a parameter of a reserved name",
     R"(Every object has the keys name, material, loader, scale, rotate and translate. A plugin
cannot use them for its own parameters.)"},
    {Code{522}, "plugin with a bad default",
     R"(The default of a parameter of the plugin is no valid value. This is an error in the plugin.)"},
    {Code{523}, "not a name of a type",
     R"(Names of types are [a-z][a-z0-9_]*, at most 64 characters. A scene can name a plugin, never
say where it lies.)"},
    {Code{530}, "plugin failed",
     R"(The plugin could not do what it was asked; its message says why.)"},
    {Code{531}, "plugin threw an exception",
     R"(An exception left the plugin. This is an error in the plugin.)"},
    {Code{532}, "plugin with impossible geometry",
     R"(The plugin handed over an index beyond its array, a number that is not finite, or the like.
This is an error in the plugin.)"},
    {Code{533}, "plugin crashed",
     R"(The plugin's own code was running when the program got a signal that ends it, or called exit. The message
names the function of the plugin that rt had called, and the place in its file where it happened: give that to
addr2line, with the plugin compiled with -g, for file and line. With 'ulimit -c unlimited' the program leaves a
core file as well.)"},

    // ---- exit 6: output
    {Code{601}, "unknown format",
     R"(The suffix of an output file says its format: .png, .jpg, .bmp, .exr or .pfm for pictures,
.mp4, .avi, .mkv or .webm for films.)"},
    {Code{602}, "no such folder",
     R"(The folder of the output file does not exist. It is not made, since it may be misspelt.)"},
    {Code{603}, "folder that cannot be written",
     R"(The folder of the output file may not be written to.)"},
    {Code{604}, "output that is no file",
     R"(The name of the output is that of a folder, a device or a pipe.)"},
    {Code{605}, "writing failed",
     R"(The file could not be written completely, for example because the disk is full. What was
at its place before is untouched.)"},
    {Code{606}, "encoding failed",
     R"(The picture or film cannot be written in this format: the reason is in the message.)"},
    {Code{607}, "file that would be replaced",
     R"(The output exists already. Name another one, or allow it to be replaced.)"},
    {Code{608}, "output in use",
     R"(Another process is writing the same file, or rendering frames into the same folder; the message says which, and since when. A lock that a
killed process has left behind is none.)"},
    {Code{609}, "frames of an earlier run",
     R"(The folder already has frames, which may have taken long to render. --resume keeps those
that are complete and renders the rest, --overwrite deletes them.)"},
    {Code{610}, "frames of another film",
     R"(--resume found frames that were rendered from another scene, other files or with other
options, so that the film would change in the middle. The message names the first field
that differs. Undo the change, render to another name, or start again with --overwrite.)"},
    {Code{611}, "job that exists",
     R"(The job directory holds another job, perhaps with finished frames. `rt farm resume` goes
on with it; --job names another directory.)"},
    {Code{612}, "tasks that are not done",
     R"(Some tasks of the job have not delivered all their frames, after several attempts each.
`rt farm status` tells what happened, the folder log what they said. After the cause is
gone, `rt farm resume` repeats these tasks only.)"},
    {Code{613}, "the farm cannot go on",
     R"(The scheduler does not answer, or a file of the job cannot be read or written.)"},
    {Code{615}, "output outside of the current folder",
     R"(The scene says where its picture goes, and a symbolic link leads from there out of the current
folder. Only -o may name such a place.)"},

    // ---- exit 7: limits
    {Code{701}, "too many primitives",
     R"(The scene has more primitives than --limit-primitives allows, or than 32 bit numbers can tell
apart.)"},
    {Code{702}, "coordinate too far out",
     R"(A coordinate is beyond what the boxes of the octree can hold.)"},
    {Code{703}, "out of memory",
     R"(There is not enough memory, or not as much as --limit-memory allows. Nothing was written.)"},
    {Code{710}, "file too large",
     R"(Scenes have at most 8 MiB, mesh files 4 GiB; --limit-file says otherwise. Large geometry belongs
into mesh files.)"},
    {Code{711}, "nested too deeply",
     R"(Lists and maps of a scene are nested at most 64 deep; --limit-nesting says otherwise.)"},
    {Code{712}, "too many nodes",
     R"(A scene has at most a million nodes (keys, values, lists and maps), each alias counting as
often as it is used; --limit-nodes says otherwise. Large geometry belongs into mesh files.)"},
    {Code{713}, "too many pixels",
     R"(A picture has at most 2^28 pixels, a texture 2^26, so that a wrong digit does not take all
memory. --limit-pixels raises the limit of the picture.)"},
    {Code{714}, "more than a plugin may take",
     R"(A texture has more texels than --limit-texture-pixels allows; 2^26 by default.)"},
    {Code{715}, "picture larger than the memory",
     R"(A picture takes about 72 bytes of memory a pixel while it is drawn and saved. The message says
how much that is, and how much there is: of --limit-memory, or of the machine.)"},
};

} // namespace

std::span<const Explanation> explanations() { return kExplanations; }

std::optional<Explanation> explanation(Code code) {
    const auto found =
        std::lower_bound(std::begin(kExplanations), std::end(kExplanations), code,
                         [](const Explanation& entry, Code wanted) { return entry.code < wanted; });
    if (found == std::end(kExplanations) || found->code != code) return std::nullopt;
    return *found;
}

} // namespace rt::scene
