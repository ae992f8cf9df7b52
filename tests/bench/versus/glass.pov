#version 3.7;
#declare Depth = 11;
#include "camera.inc"
Eye(<0.3, -5.2, 2>, <0, 0, 0.6>, 38)
background { rgb <0.55, 0.7, 0.9> }
light_source { <4, -6, 8> rgb 0.9 }
polygon { 5, <-20, -20, 0>, <20, -20, 0>, <20, 20, 0>, <-20, 20, 0>, <-20, -20, 0>
  texture { pigment { checker rgb 0.85, rgb <0.15, 0.25, 0.4> translate <0, 0, -0.5> } finish { ambient 0 diffuse 0.8 } } }
#macro Glass(Color)
  texture { pigment { rgbf <Color.x, Color.y, Color.z, 1> }
            finish { ambient 0 diffuse 0 specular 0.08 roughness 1 / 200 reflection { 0.08 } } }
  interior { ior 1.5 }
#end
sphere { <-1.1, 0, 0.72>, 0.7 Glass(<0.9, 0.9, 0.9>) }
sphere { <0.5, 0.6, 0.62>, 0.6 Glass(<0.9, 0.6, 0.25>) }
sphere { <0.3, -1, 0.42>, 0.4 Glass(<0.9, 0.9, 0.9>) }
sphere { <1.5, -0.4, 0.52>, 0.5 Glass(<0.9, 0.6, 0.25>) }
sphere { <-0.4, 1.9, 0.82>, 0.8 Glass(<0.9, 0.9, 0.9>) }
