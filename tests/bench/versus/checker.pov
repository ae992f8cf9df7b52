#version 3.7;
#declare Depth = 5;
#include "camera.inc"
Eye(<0, -9, 3>, <0, 0, 0.4>, 36)
background { rgb <0.6, 0.75, 0.95> }
light_source { <6, -8, 9> rgb 0.8 }
light_source { <-7, -6, 6> rgb 0.3 }
polygon { 5, <-200, -200, 0>, <200, -200, 0>, <200, 200, 0>, <-200, 200, 0>, <-200, -200, 0>
  texture { pigment { checker rgb 0.9, rgb 0.2 translate <0, 0, -0.5> }
            finish { ambient 0 diffuse 0.8 } } }
#declare Red = texture { pigment { rgb <0.9, 0.2, 0.15> } finish { ambient 0 diffuse 0.8 specular 0.15 roughness 1 / 40
                                                              reflection { rgb 0.15 * <0.9, 0.2, 0.15> } } }
#declare Mirror = texture { pigment { rgb <0.9, 0.95, 1> } finish { ambient 0 diffuse 0.1 specular 0.8 roughness 1 / 100
                                                                reflection { rgb 0.8 * <0.9, 0.95, 1> } } }
#declare I = 0;
#while (I < 10)
  #declare J = 0;
  #while (J < 10)
    sphere { <-4.05 + 0.9 * I, -3 + 0.9 * J, 0.33>, 0.32 texture { #if (mod(I + J, 3) = 0) Mirror #else Red #end } }
    #declare J = J + 1;
  #end
  #declare I = I + 1;
#end
