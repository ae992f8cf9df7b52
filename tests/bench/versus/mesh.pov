#version 3.7;
#declare Depth = 6;
#include "camera.inc"
Eye(<0.8, -3.6, 1.9>, <0, 0.2, 0.5>, 40)
background { rgb <0.4, 0.55, 0.8> }
light_source { <4, -6, 7> rgb 0.9 }
light_source { <-6, -3, 5> rgb 0.3 }
polygon { 5, <-20, -20, 0>, <20, -20, 0>, <20, 20, 0>, <-20, 20, 0>, <-20, -20, 0>
  texture { pigment { rgb <0.7, 0.66, 0.6> } finish { ambient 0 diffuse 0.8 } } }
polygon { 5, <-1.8, 1.6, 0>, <1.8, 2, 0>, <1.8, 2, 1.8>, <-1.8, 1.6, 1.8>, <-1.8, 1.6, 0>
  texture { pigment { rgb 0.95 } finish { ambient 0 diffuse 0.05 specular 0.9 roughness 1 / 200
                                          reflection { 0.9 * 0.95 } } } }
#include "knot.inc" // made of knot.obj by versus.py
object { Knot texture { pigment { rgb <0.95, 0.7, 0.4> } finish { ambient 0 diffuse 0.5 specular 0.3 roughness 1 / 40
                                                                 reflection { rgb 0.3 * <0.95, 0.7, 0.4> } } } }
