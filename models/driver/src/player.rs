//! Pages that play a motion: a canvas, a button and a slider, without any library.

/// The script of a page: a function of `root`, which has a `canvas`, a `button` and an `input`, and of `data`:
///
/// | key | content |
/// |---|---|
/// | `title`, `labels` | title; labels of both axes |
/// | `box` | shown part of the plane: left, right, low, high |
/// | `ticks` | ticks of both axes |
/// | `equal` | true for equal scales of both axes |
/// | `height`, `fps` | height of the canvas, in pixels; frames in a second |
/// | `times` | times of the frames, in order |
/// | `borders` | polylines behind the motion: one list for all frames, or one for each frame |
/// | `curves` | for each curve its `label`; the points of its `path` with their `times`; `heads`, its point at each frame; `impacts`, each as time and point |
///
/// A point is a pair of numbers. A point with a null interrupts its line.
pub const SCRIPT: &str = include_str!("player.js");

/// The elements and the script of a player, in a page in which no other element is called `name`. `data` is JSON.
pub fn element(name: &str, data: &str) -> String {
    // A name that contains `</script>` must not end the script.
    let data = data.replace('<', "\\u003c");
    format!(
        "<div id='{name}'><canvas></canvas><br><button style='width: 3em'></button> \
         <input type='range' min='0' value='0' style='width: 560px'></div>\
         <script>{}(document.getElementById('{name}'), {data});</script>",
        SCRIPT.trim_end()
    )
}
